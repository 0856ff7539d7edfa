# One R program, one question: Rscript worker.R PROGRAM WORK DATA.npy ANSWER.f64 LOW HIGH CELLS KERNEL BANDWIDTH REPEATS ENOUGH
# Prints the same line of JSON as worker.py. The answer is written as raw little-endian doubles.

arguments <- commandArgs(trailingOnly = TRUE)
program <- arguments[1]
place <- arguments[2]
kernel <- arguments[8]
low <- as.numeric(arguments[5])
high <- as.numeric(arguments[6])
cells <- as.integer(arguments[7])
bandwidth <- as.numeric(arguments[9])
first <- low + (high - low) / cells / 2
last <- high - (high - low) / cells / 2

finish <- function(line) {
  cat(line, "\n", sep = "")
  quit(save = "no")
}

deviation <- bandwidth * switch(kernel, gaussian = 1, epanechnikov = 1 / sqrt(5), NA)
version <- as.character(getRversion())
estimate <- NULL
if (program == "R density" && place == "grid") {
  # R's bw is the deviation of every kernel.
  estimate <- function(x) density(x, bw = deviation, kernel = kernel, n = cells, from = first, to = last)$y
} else if (program == "R KernSmooth bkde" && place == "grid") {
  if (!requireNamespace("KernSmooth", quietly = TRUE)) finish('{"status": "not installed"}')
  version <- as.character(packageVersion("KernSmooth"))
  named <- switch(kernel, gaussian = "normal", epanechnikov = "epanech")
  estimate <- function(x) {
    KernSmooth::bkde(x, kernel = named, canonical = FALSE, bandwidth = bandwidth, gridsize = cells,
                     range.x = c(first, last), truncate = TRUE)$y
  }
} else if (program == "R hist" && place == "bins") {
  edges <- low + (high - low) * (0:cells) / cells
  estimate <- function(x) hist(x, breaks = edges, right = FALSE, plot = FALSE)$counts
}
stopifnot(!is.null(estimate))

# .npy, format 1: magic and version (8 bytes), length of the header (2 bytes), header, little-endian doubles.
file <- file(arguments[3], "rb")
preamble <- readBin(file, "raw", 8)
stopifnot(preamble[7] == 1)
header <- readChar(file, readBin(file, "integer", 1, size = 2, signed = FALSE, endian = "little"))
stopifnot(grepl("'<f8'", header, fixed = TRUE))
n <- as.numeric(sub(".*'shape': \\(([0-9]+),.*", "\\1", header))
x <- readBin(file, "double", n, endian = "little")
close(file)

peak <- function() {
  line <- grep("VmHWM", readLines("/proc/self/status"), value = TRUE)
  as.numeric(gsub("[^0-9]", "", line)) * 1024
}

invisible(estimate(x[1:1000]))
before <- peak()
cpu <- c()
wall <- c()
while (length(cpu) < as.integer(arguments[10]) && sum(wall) < as.numeric(arguments[11])) {
  start <- proc.time()
  result <- estimate(x)
  spent <- proc.time() - start
  cpu <- c(cpu, spent[["user.self"]] + spent[["sys.self"]])
  wall <- c(wall, spent[["elapsed"]])
}
middle <- order(cpu)[(length(cpu) + 1) %/% 2]
after <- peak()
writeBin(as.numeric(result), arguments[4], endian = "little")
finish(sprintf('{"status": "ok", "version": "%s", "cpu": %.6f, "wall": %.6f, "peak": %.0f, "extra": %.0f}',
               version, cpu[middle], wall[middle], after, after - before))
