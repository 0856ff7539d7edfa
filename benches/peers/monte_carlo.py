#!/usr/bin/env python3
"""Replicates a second of one Monte Carlo loop: draw n = 1000 points, estimate on 512 places, integrate the squared error.

    python3 benches/peers/monte_carlo.py --lab target/release/lab

The same loop in `lab run`, R's density(), SciPy and KDEpy, each in a process of its own on one thread, in turn. CPU seconds of the loop alone for the peers; of the
whole process for `lab`, which also reads the experiment and writes its tables and report. The mean of the errors is printed too: all must agree on the MISE.

`lab` runs twice: exact, and with the tolerance 1e-6, whose values are still some thousand times nearer to the sum as written than those of R's density() are.
"""

import argparse
import json
import os
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

import environment

N, PLACES, LOW, HIGH, H = 1000, 512, -4.0, 4.0, 0.2208
TOLERANCES = {"lab, exact": 1e-12, "lab, tolerance 1e-6": 1e-6}
HERE = Path(__file__).resolve().parent

EXPERIMENT = """question = "How fast?"
seed = 1
source = {{ density = "mw-6" }}
draws = {n}
replicates = {replicates}
grid = {{ low = {low}, high = {high}, cells = {places} }}
[[estimator]]
name = "kernel"
kernel = {{ bandwidth = {h}, tolerance = {tolerance} }}
"""

R = """
n <- {n}; h <- {h}; m <- {places}; low <- {low}; high <- {high}
step <- (high - low) / m; first <- low + step / 2; last <- high - step / 2
x <- seq(first, last, length.out = m)
f <- 0.5 * dnorm(x, -1, 2 / 3) + 0.5 * dnorm(x, 1, 2 / 3)
set.seed(1)
one <- function() {{
  sample <- rnorm(n, ifelse(runif(n) < 0.5, -1, 1), 2 / 3)
  y <- density(sample, bw = h, n = m, from = first, to = last)$y
  sum((y - f)^2) * step
}}
for (i in 1:20) one()
start <- proc.time()
errors <- vapply(1:{replicates}, function(i) one(), 0)
spent <- proc.time() - start
cat(sprintf('{{"cpu": %.6f, "mise": %.9f}}', spent[["user.self"]] + spent[["sys.self"]], mean(errors)))
"""


def peer(name, replicates):
    """The loop in Python, in this process."""
    import numpy as np

    step = (HIGH - LOW) / PLACES
    x = LOW + step * (np.arange(PLACES) + 0.5)
    normal = lambda at: np.exp(-0.5 * ((x - at) / (2 / 3)) ** 2) / (2 / 3) / np.sqrt(2 * np.pi)
    f = 0.5 * (normal(-1) + normal(1))
    random = np.random.default_rng(1)
    if name == "SciPy gaussian_kde":
        from scipy.stats import gaussian_kde

        estimate = lambda sample: gaussian_kde(sample, bw_method=H / sample.std(ddof=1))(x)
    else:
        from KDEpy import FFTKDE

        wide = np.linspace(LOW - 4 + step / 2, HIGH + 4 - step / 2, PLACES * 2)
        # KDEpy wants all data inside its grid: the same spacing, twice as wide, cut afterwards
        estimate = lambda sample: FFTKDE(kernel="gaussian", bw=H).fit(sample).evaluate(wide)[PLACES // 2 : PLACES // 2 + PLACES]

    def one():
        sample = np.where(random.random(N) < 0.5, -1.0, 1.0) + random.standard_normal(N) * (2 / 3)
        return ((estimate(sample) - f) ** 2).sum() * step

    for _ in range(5):
        one()
    before = resource.getrusage(resource.RUSAGE_SELF)
    errors = [one() for _ in range(replicates)]
    after = resource.getrusage(resource.RUSAGE_SELF)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    print(json.dumps({"cpu": cpu, "mise": sum(errors) / len(errors)}))


def lab(program, replicates, tolerance):
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "throughput.toml"
        values = dict(n=N, replicates=replicates, low=LOW, high=HIGH, places=PLACES, h=H, tolerance=tolerance)
        file.write_text(EXPERIMENT.format(**values))
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        call = [program, "run", file, "--out", Path(folder) / "run", "--json", "--quiet", "--threads", "1"]
        done = subprocess.run([str(part) for part in call], capture_output=True, text=True, check=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        table = (Path(folder) / "run" / "tables" / "summary.csv").read_text().splitlines()
        mise = next(line.split(",")[4] for line in table if ",mise," in line)
        return {"cpu": cpu, "mise": float(mise), "said": len(done.stdout)}


def measure(name, options, replicates):
    if name.startswith("lab"):
        return lab(options.lab.resolve(), replicates, TOLERANCES[name])
    if name == "R density":
        values = dict(n=N, replicates=replicates, low=LOW, high=HIGH, places=PLACES, h=H)
        call = ["Rscript", "--vanilla", "-e", R.format(**values)]
    else:
        call = [options.python, Path(__file__).resolve(), "--peer", name, "--replicates", replicates]
    done = subprocess.run([str(part) for part in call], capture_output=True, text=True, check=True, cwd=HERE)
    return json.loads(done.stdout.strip().splitlines()[-1])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--lab", type=Path, default=HERE.parent.parent / "target" / "release" / "lab")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--python", default=environment.PYTHON, help="a Python that has SciPy and KDEpy (default: the one that is installed here)")
    parser.add_argument("--peer", help=argparse.SUPPRESS)
    parser.add_argument("--replicates", type=int, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.peer:
        return peer(options.peer, options.replicates)
    if options.python == environment.PYTHON:
        environment.ensure()
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ[name] = "1"
    # enough replicates for about a second each
    works = {"lab, tolerance 1e-6": 60_000, "lab, exact": 60_000, "R density": 3000, "SciPy gaussian_kde": 100, "KDEpy FFTKDE": 1000}
    if shutil.which("Rscript") is None:
        del works["R density"]
    rates = {name: [] for name in works}
    errors = {}
    for _ in range(options.rounds):
        for name, replicates in works.items():
            found = measure(name, options, replicates)
            rates[name].append(replicates / found["cpu"])
            errors[name] = found["mise"]
    best = max(statistics.median(rate) for name, rate in rates.items() if name not in TOLERANCES)
    print("| program | replicates per CPU second: median (min - max) | estimated values per CPU second | over the best peer | MISE |")
    print("| --- | --- | --- | --- | --- |")
    for name, rate in sorted(rates.items(), key=lambda item: -statistics.median(item[1])):
        middle = statistics.median(rate)
        print(f"| {name} | {middle:,.0f} ({min(rate):,.0f} - {max(rate):,.0f}) | {middle * PLACES:.2e} | {middle / best:.1f} | {errors[name]:.3e} |")
    return 0


if __name__ == "__main__":
    sys.exit(main())
