"""The questions that every program is asked. No third-party import: the runner uses it too."""

from dataclasses import dataclass

# Cell-centred, as everywhere in `lab`: centre i is LOW + (i + 1/2) (HIGH - LOW) / CELLS.
# Wide enough that every data point lies between the first and the last centre (KDEpy requires it).
LOW, HIGH, CELLS = -6.0, 6.0, 1024
STEP = (HIGH - LOW) / CELLS
FIRST = LOW + STEP / 2
LAST = HIGH - STEP / 2

SEEDS = {"normal": 19860101, "bimodal": 19860102}

# In its process a program estimates so often, or until so many seconds are gone, and the median counts.
REPEATS = 5
ENOUGH = 1.0

# A program whose answer is within this of the definition, relative to the peak, counts as exact.
EXACT = 1e-9


@dataclass(frozen=True)
class Work:
    """One question: which kernel, which textbook bandwidth, where."""

    name: str
    kernel: str  # "gaussian" (unit deviation), "epanechnikov" (support [-1, 1]), "none" for counts
    bandwidth: float
    at: str  # "grid", "points" (the data themselves) or "bins"
    title: str


WORKS = {
    work.name: work
    for work in (
        Work("histogram", "none", 0.0, "bins", f"histogram, {CELLS} bins"),
        Work("gaussian-grid", "gaussian", 0.05, "grid", f"Gaussian, h = 0.05, {CELLS}-point grid"),
        Work("epanechnikov-grid", "epanechnikov", 0.1, "grid", f"Epanechnikov, h = 0.1, {CELLS}-point grid"),
        Work("gaussian-points", "gaussian", 0.05, "points", "Gaussian, h = 0.05, at the data points"),
        Work("epanechnikov-points", "epanechnikov", 0.1, "points", "Epanechnikov, h = 0.1, at the data points"),
    )
}
