# R's density() as an estimator of the laboratory: points and targets in, densities out.
# The first line is "points targets dimensions"; then x,w for each point and x for each target.
input   <- file("stdin", open = "r")
size    <- scan(input, what = integer(), n = 3, quiet = TRUE)
points  <- matrix(scan(input, sep = ",", n = 2 * size[1], quiet = TRUE), ncol = 2, byrow = TRUE)
targets <- scan(input, n = size[2], quiet = TRUE)
weights <- points[, 2]
rule    <- commandArgs(trailingOnly = TRUE)
fitted  <- density(points[, 1], bw = if (length(rule)) rule[1] else "nrd0", weights = weights / sum(weights),
                   n = 4096, from = min(targets), to = max(targets))
values  <- sum(weights) * approx(fitted$x, fitted$y, targets, rule = 2)$y
writeLines(format(values, digits = 17))
