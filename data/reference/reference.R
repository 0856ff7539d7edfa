# Makes bandwidths.csv and densities.csv from the data sets beside this folder:
#
#     cd data/reference && Rscript reference.R
#
# Nothing here is binned unless the column says so: the densities are direct sums,
# and nrd0 and nrd are closed formulae of the deviation and the quartiles.

options(digits = 17)

column <- function(folder, name) {
  read.csv(file.path("..", folder, paste0(folder, ".csv")))[[name]]
}

samples <- list(
  list("old_faithful_107", "eruption_min"),
  list("galaxies_82", "velocity_km_s"),
  list("galaxies_82", "velocity_km_s_mass"),
  list("suicide_86", "treatment_days"),
  list("buffalo_63", "snowfall_inch"),
  list("faithful_272", "eruptions_min"),
  list("faithful_272", "waiting_min"),
  list("quakes_1000", "depth_km"),
  list("quakes_1000", "magnitude")
)

text <- function(value) formatC(value, digits = 17, format = "g", width = 1)

# The seven kernels with the textbook bandwidth: support [-1, 1], Gaussian of unit deviation.
kernels <- list(
  uniform      = function(u) ifelse(abs(u) <= 1, 1 / 2, 0),
  triangular   = function(u) pmax(1 - abs(u), 0),
  epanechnikov = function(u) 3 / 4 * pmax(1 - u^2, 0),
  biweight     = function(u) 15 / 16 * pmax(1 - u^2, 0)^2,
  triweight    = function(u) 35 / 32 * pmax(1 - u^2, 0)^3,
  cosine       = function(u) ifelse(abs(u) <= 1, pi / 4 * cos(pi * u / 2), 0),
  gaussian     = dnorm
)

bandwidths <- NULL
densities <- NULL
for (entry in samples) {
  folder <- entry[[1]]
  name <- entry[[2]]
  x <- as.numeric(column(folder, name))
  quartiles <- quantile(x, c(0.25, 0.75), names = FALSE)  # type 7
  row <- c(folder, name, length(x), text(c(
    mean(x), sd(x), quartiles, bw.nrd0(x), bw.nrd(x)
  )))
  bandwidths <- rbind(bandwidths, row)

  # Five places off the data's own lattice, at one and at a third of the normal reference.
  places <- min(x) + diff(range(x)) * c(0.0137, 0.2519, 0.4973, 0.7541, 0.9871)
  for (h in bw.nrd(x) * c(1, 1 / 3)) for (kernel in names(kernels)) {
    values <- vapply(places, function(p) mean(kernels[[kernel]]((p - x) / h)) / h, 0)
    densities <- rbind(densities, cbind(folder, name, kernel, text(h), text(places), text(values)))
  }
}

save <- function(rows, header, file) {
  colnames(rows) <- header
  write.csv(rows, file, row.names = FALSE, quote = FALSE)
}
save(bandwidths, c("data", "column", "n", "mean", "deviation", "quartile_1", "quartile_3", "nrd0", "nrd"),
     "bandwidths.csv")
save(densities, c("data", "column", "kernel", "bandwidth", "x", "density"), "densities.csv")
