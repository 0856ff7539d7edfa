# Makes selectors.csv from the data sets beside this folder:
#
#     cd data/reference && Rscript selectors.R
#
# R's own bw.SJ, bw.ucv and bw.bcv bin the differences of the data into nb = 1000 cells and stop early (tol = a tenth of
# the lower end). Here the same formulae are summed over all pairs, n^2 of them, and solved to 1e-12; R's own answers
# stand beside them in the columns that end in `_r`.

column <- function(folder, name) {
  as.numeric(read.csv(file.path("..", folder, paste0(folder, ".csv")))[[name]])
}

samples <- list(
  list("old_faithful_107", "eruption_min"),
  list("suicide_86", "treatment_days"),
  list("galaxies_82", "velocity_km_s"),
  list("buffalo_63", "snowfall_inch"),
  list("faithful_272", "waiting_min"),
  list("quakes_1000", "depth_km")
)

# He_r(u) phi(u) = (-1)^r phi^(r)(u)
hermite <- function(r, u) {
  before <- 0 * u; now <- before + 1
  for (k in seq_len(r) - 1) { after <- u * now - k * before; before <- now; now <- after }
  now
}
# sum over all pairs, i = j included, of phi^(r)((x_i - x_j) / g); even r. Equal differences are counted once, with
# their number, and what is below the least number at 38 deviations is left out.
differences <- function(x) {
  d <- abs(outer(x, x, "-")); d <- rle(sort(round(d, 9)))
  list(at = d$values, number = d$lengths)
}
pairs <- function(d, r, g) {
  near <- d$at < 38 * g; u <- d$at[near] / g
  sum(d$number[near] * hermite(r, u) * dnorm(u))
}

sheather_jones <- function(x) {
  n <- length(x); d <- differences(x)
  # as R: divided by n (n - 1) though the diagonal is in
  sd4 <- function(g) pairs(d, 4, g) / (n * (n - 1) * g^5)
  td6 <- function(g) pairs(d, 6, g) / (n * (n - 1) * g^7)
  scale <- min(sd(x), IQR(x) / 1.349)
  a <- 1.24 * scale * n^(-1/7); b <- 1.23 * scale * n^(-1/9)
  c1 <- 1 / (2 * sqrt(pi) * n)
  td <- -td6(b)
  dpi <- (c1 / sd4((2.394 / (n * td))^(1/7)))^(1/5)
  alpha <- 1.357 * (sd4(a) / td)^(1/7)
  f <- function(h) (c1 / sd4(alpha * h^(5/7)))^(1/5) - h
  hmax <- 1.144 * scale * n^(-1/5); lower <- 0.1 * hmax; upper <- hmax; try <- 1
  while (f(lower) * f(upper) > 0) {
    if (try %% 2) upper <- upper * 1.2 else lower <- lower / 1.2
    try <- try + 1
  }
  c(ste = uniroot(f, c(lower, upper), tol = 1e-13 * upper)$root, dpi = dpi)
}

cross_validation <- function(x) {
  n <- length(x); d <- outer(x, x, "-"); d <- abs(d[upper.tri(d)])
  hmax <- 1.144 * sd(x) * n^(-1/5)
  ucv <- function(h) {
    delta <- (d / h)^2
    (0.5 + sum(exp(-delta / 4) - sqrt(8) * exp(-delta / 2)) / n) / (n * h * sqrt(pi))
  }
  bcv <- function(h) {
    delta <- (d / h)^2
    (1 + sum(exp(-delta / 4) * (delta^2 - 12 * delta + 12)) / (32 * n)) / (2 * n * h * sqrt(pi))
  }
  # least-squares cross-validation proper: leave-one-out with n - 1
  lscv <- function(h) {
    (1 / (2 * sqrt(pi) * h)) * (1 / n + 2 / n^2 * sum(exp(-(d / h)^2 / 4))) - 4 / (n * (n - 1) * h) * sum(dnorm(d / h))
  }
  # the least value on a fine ladder, refined: the minimum over the interval, whatever its shape
  least <- function(f) {
    ladder <- hmax * 10^seq(-1, 0, length.out = 100)
    values <- vapply(ladder, f, 0); i <- which.min(values)
    ends <- ladder[pmin(pmax(i + c(-1, 1), 1), 100)]
    optimize(f, ends, tol = 1e-10 * hmax)$minimum
  }
  epanechnikov <- function(h) {
    # (K * K)(u) = 3/160 (2 - u)^3 (u^2 + 6 u + 4) on [0, 2]
    u <- d / h
    kk <- 3 / 160 * pmax(2 - u, 0)^3 * (u^2 + 6 * u + 4); k <- 3 / 4 * pmax(1 - u^2, 0)
    (0.6 / n + 2 / n^2 * sum(kk)) / h - 4 / (n * (n - 1) * h) * sum(k)
  }
  at <- 0.5 * hmax
  c(ucv = least(ucv), bcv = least(bcv), lscv = least(lscv),
    h = at, lscv_value = lscv(at), epanechnikov_value = epanechnikov(at))
}

# Botev, Grotowski & Kroese 2010, section 5, on the line: squared norms of derivatives as sums over pairs
improved <- function(x) {
  n <- length(x); d <- differences(x)
  norm <- function(s, t) { g <- sqrt(2 * t); (-1)^s * pairs(d, 2 * s, g) / (n^2 * g^(2 * s + 1)) }
  f <- function(t) {
    now <- norm(7, t)
    for (s in 6:2) {
      k0 <- prod(seq(1, 2 * s - 1, 2)) / sqrt(2 * pi); const <- (1 + 0.5^(s + 0.5)) / 3
      now <- norm(s, (2 * const * k0 / n / now)^(2 / (3 + 2 * s)))
    }
    t - (2 * n * sqrt(pi) * now)^(-2/5)
  }
  h <- diff(range(x)) * 10^seq(-3.5, -0.5, length.out = 61)
  values <- vapply(h^2, f, 0)
  i <- which(values[-1] > 0 & values[-61] <= 0)[1]
  sqrt(uniroot(f, h[i + 0:1]^2, tol = 1e-14 * h[i]^2)$root)
}

# log-likelihood of each point given the others, Gaussian kernel; no floor
likelihood <- function(x, h) {
  n <- length(x); k <- dnorm(outer(x, x, "-") / h) / h; diag(k) <- 0
  mean(log(rowSums(k) / (n - 1)))
}

rows <- NULL
for (entry in samples) {
  x <- column(entry[[1]], entry[[2]]); n <- length(x)
  values <- c(sheather_jones(x), cross_validation(x), isj = improved(x))
  values <- c(values, likelihood_value = likelihood(x, values[["h"]]),
    ste_r = bw.SJ(x), dpi_r = bw.SJ(x, method = "dpi"),
    ucv_r = suppressWarnings(bw.ucv(x)), bcv_r = suppressWarnings(bw.bcv(x)))
  rows <- rbind(rows, c(data = entry[[1]], column = entry[[2]], n = n,
    vapply(values, formatC, "", digits = 15, format = "g", width = 1)))
}
write.csv(rows, "selectors.csv", row.names = FALSE, quote = FALSE)
