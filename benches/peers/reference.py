"""The data files and the exact answers, both kept in the cache folder.

    reference.py data NAME N FILE          a sample
    reference.py exact WORK DATA.npy FILE  indices of some targets and the exact answers there
    reference.py error ANSWER EXACT.npz    the largest difference, relative to the peak

The answer of the definition: all kernel values in 80-bit extended precision, summed in extended precision, over the
points within ten bandwidths (a Gaussian is below 2e-22 of its peak there). It shares no code with any program compared.
"""

import sys

import numpy as np

from work import CELLS, FIRST, HIGH, LOW, SEEDS, STEP, WORKS

TARGETS = 128


def sample(name, n):
    random = np.random.Generator(np.random.PCG64(SEEDS[name]))
    x = random.standard_normal(n)
    if name == "bimodal":
        # Number six of Marron and Wand (1992): equal halves N(-1, (2/3)²) and N(1, (2/3)²).
        x = x * (2.0 / 3.0) + np.where(random.random(n) < 0.5, -1.0, 1.0)
    assert np.abs(x).max() < HIGH - STEP, "the grid must hold the data"
    return x


def exact(work, x):
    if work.at == "bins":
        edges = LOW + (HIGH - LOW) * np.arange(CELLS + 1) / CELLS
        counts = np.diff(np.searchsorted(np.sort(x), edges, side="left"))
        return np.arange(CELLS), counts.astype(np.float64)
    random = np.random.Generator(np.random.PCG64(7))
    places = FIRST + STEP * np.arange(CELLS) if work.at == "grid" else x
    chosen = random.choice(len(places), TARGETS, replace=False)
    # The peak of both samples and places near it must be among them: errors are relative to it.
    centre = [np.abs(places - p).argmin() for p in (-1.0, 0.0, 1.0)]
    chosen = np.unique(np.concatenate([chosen, centre]))
    ordered = np.sort(x)
    return chosen, np.array([density(work, ordered, places[i]) for i in chosen])


def density(work, ordered, place):
    h = np.longdouble(work.bandwidth)
    reach = (10.0 if work.kernel == "gaussian" else 1.0) * work.bandwidth * (1 + 1e-12)
    low, high = np.searchsorted(ordered, [place - reach, place + reach])
    total = np.longdouble(0)
    for start in range(low, high, 1 << 20):
        u = (ordered[start : min(start + (1 << 20), high)].astype(np.longdouble) - np.longdouble(place)) / h
        if work.kernel == "gaussian":
            total += np.exp(-u * u / 2).sum()
        else:
            total += np.maximum(1 - u * u, 0).sum()
    if work.kernel == "gaussian":
        # 1 / √(2π) to twenty digits; np.pi would cut it at double precision.
        constant = np.longdouble("0.39894228040143267794")
    else:
        constant = np.longdouble(3) / 4
    return float(total * constant / h / len(ordered))


def error(answer, known):
    values = np.load(answer) if answer.endswith(".npy") else np.fromfile(answer, dtype="<f8")
    reference = np.load(known)
    if len(values) != reference["size"]:
        return float("nan")
    return float(np.abs(values[reference["chosen"]] - reference["values"]).max() / reference["values"].max())


def main():
    match sys.argv[1:]:
        case ["data", name, n, file]:
            np.save(file, sample(name, int(n)))
        case ["exact", work, data, file]:
            x = np.load(data)
            chosen, values = exact(WORKS[work], x)
            np.savez(file, chosen=chosen, values=values, size=len(x) if WORKS[work].at == "points" else CELLS)
        case ["error", answer, known]:
            print(error(answer, known))
        case _:
            sys.exit(__doc__)


if __name__ == "__main__":
    main()
