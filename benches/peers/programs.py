"""The peers written for Python, each with the fastest settings that answer the same question.

A constructor of `PROGRAMS` gets the work and returns `(version, estimate)`; `estimate(x)` is what is timed. It gets the data as a
contiguous float64 array and returns densities at the grid's centres, at the data, or the counts of the bins.
Bandwidths are textbook ones; where a library means another thing by the word, it is converted here.
"""

import json
import math
from importlib.metadata import version

import numpy as np

from work import CELLS, FIRST, HIGH, LAST, LOW

GRID = np.linspace(FIRST, LAST, CELLS)
DEVIATION = {"gaussian": 1.0, "epanechnikov": 1.0 / math.sqrt(5.0)}  # of the kernel with h = 1


def numpy_histogram(work):
    return version("numpy"), lambda x: np.histogram(x, bins=CELLS, range=(LOW, HIGH))[0]


def fast_histogram(work):
    from fast_histogram import histogram1d

    return version("fast-histogram"), lambda x: histogram1d(x, bins=CELLS, range=(LOW, HIGH))


def boost_histogram(work, threads=1):
    import boost_histogram as bh

    def estimate(x):
        counts = bh.Histogram(bh.axis.Regular(CELLS, LOW, HIGH, underflow=False, overflow=False), storage=bh.storage.Int64())
        counts.fill(x, threads=threads)
        return counts.view()

    return version("boost-histogram"), estimate


def boost_histogram_two(work):
    return boost_histogram(work, threads=2)


def kernsmooth(work):
    """Linear binning in Fortran, transforms in numpy. The whole grid is asked for: bins and answers coincide."""
    from r2py_kernsmooth import bkde

    kernel = {"gaussian": "normal", "epanechnikov": "epanech"}[work.kernel]
    ends = np.array([FIRST, LAST])

    def estimate(x):
        return bkde(x, kernel=kernel, canonical=False, bandwidth=work.bandwidth, gridsize=CELLS, range_x=ends)["y"]

    return version("r2py_kernsmooth"), estimate


def kdepy_fft(work):
    from KDEpy import FFTKDE

    kernel = {"gaussian": "gaussian", "epanechnikov": "epa"}[work.kernel]
    deviation = work.bandwidth * DEVIATION[work.kernel]  # KDEpy's bw is the deviation of every kernel
    return version("KDEpy"), lambda x: FFTKDE(kernel=kernel, bw=deviation).fit(x).evaluate(GRID)


def kdepy_tree(work):
    from KDEpy import TreeKDE

    kernel = {"gaussian": "gaussian", "epanechnikov": "epa"}[work.kernel]
    deviation = work.bandwidth * DEVIATION[work.kernel]

    def estimate(x):
        return TreeKDE(kernel=kernel, bw=deviation).fit(x).evaluate(targets(work, x))

    return version("KDEpy"), estimate


def scipy(work):
    """Exact by definition: every point meets every target."""
    from scipy.stats import gaussian_kde

    def estimate(x):
        # A number given as bw_method is multiplied by the deviation of the data.
        return gaussian_kde(x, bw_method=work.bandwidth / x.std(ddof=1))(targets(work, x))

    return version("scipy"), estimate


def scikit_learn(work):
    """Tolerances left at zero: exact up to rounding."""
    from sklearn.neighbors import KernelDensity

    def estimate(x):
        model = KernelDensity(kernel=work.kernel, bandwidth=work.bandwidth, algorithm="kd_tree").fit(x[:, None])
        return np.exp(model.score_samples(targets(work, x)[:, None]))

    return version("scikit-learn"), estimate


def mlpack(work, relative=0.0, absolute=0.0):
    """Dual trees. The data are copied: mlpack would otherwise permute the caller's array."""
    from mlpack import kde

    def estimate(x):
        answer = kde(
            reference=x[:, None], query=targets(work, x)[:, None], kernel=work.kernel, bandwidth=work.bandwidth,
            rel_error=relative, abs_error=absolute, tree="kd-tree", algorithm="dual-tree", copy_all_inputs=True,
        )
        return np.asarray(answer["predictions"]).ravel()

    return version("mlpack"), estimate


def mlpack_approximate(work):
    return mlpack(work, relative=1e-4)


def kern(work):
    """Sums every pair."""
    from kern import KernelDensity

    def estimate(x):
        model = KernelDensity(bandwidth=work.bandwidth, kernel=work.kernel).fit(x)
        return with_self(work, x, model.self_density()) if work.at == "points" else model.evaluate(GRID)

    return version("kern_kde"), estimate


def kern_sorted(work, **options):
    """Sorts, then sums the neighbours within the support, or within four bandwidths of a Gaussian."""
    from kern import ApproximateKernelDensity

    def estimate(x):
        model = ApproximateKernelDensity(bandwidth=work.bandwidth, kernel=work.kernel, **options).fit(x)
        return with_self(work, x, model.self_density()) if work.at == "points" else model.evaluate(GRID)

    return version("kern_kde"), estimate


def kern_schraudolph(work):
    return kern_sorted(work, fast_gaussian=True)


def targets(work, x):
    return x if work.at == "points" else GRID


def with_self(work, x, left_out):
    """kern's own-sample densities leave each point out of its sum; the question here keeps it."""
    centre = {"gaussian": 1.0 / math.sqrt(2.0 * math.pi), "epanechnikov": 0.75}[work.kernel]
    return (left_out * (len(x) - 1) + centre / work.bandwidth) / len(x)


GRIDS = ("gaussian-grid", "epanechnikov-grid")
KERNELS = (*GRIDS, "gaussian-points", "epanechnikov-points")
GAUSSIANS = ("gaussian-grid", "gaussian-points")

# Name in the table -> constructor, and the works it can do.
PROGRAMS = {
    "numpy.histogram": (numpy_histogram, ("histogram",)),
    "fast-histogram": (fast_histogram, ("histogram",)),
    "boost-histogram": (boost_histogram, ("histogram",)),
    "boost-histogram, 2 threads": (boost_histogram_two, ("histogram",)),
    "KernSmooth bkde (r2py)": (kernsmooth, GRIDS),
    "KDEpy FFTKDE": (kdepy_fft, GRIDS),
    "KDEpy TreeKDE": (kdepy_tree, KERNELS),
    "SciPy gaussian_kde": (scipy, GAUSSIANS),
    "scikit-learn": (scikit_learn, KERNELS),
    "mlpack": (mlpack, KERNELS),
    "mlpack, 1e-4": (mlpack_approximate, KERNELS),
    "kern": (kern, KERNELS),
    "kern, sorted": (kern_sorted, KERNELS),
    "kern, sorted, fast exp": (kern_schraudolph, GAUSSIANS),
}

if __name__ == "__main__":
    print(json.dumps({name: works for name, (_, works) in PROGRAMS.items()}))
