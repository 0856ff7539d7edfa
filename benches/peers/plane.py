#!/usr/bin/env python3
"""The same comparison in the plane: `lab`'s engines and its peers on the same file, in turn, as a Markdown table.

    python3 benches/peers/plane.py [--n 1000000] [--rounds 3] [--bandwidth 0.1] [--python PYTHON]

Standard normal points, a grid of 256 x 256 cells on [-4, 4]^2, all at one textbook bandwidth h (half the support of a compact kernel, the deviation of
the Gaussian). Every number comes from a process of its own; CPU time of the estimation alone, imports and reading excluded, one thread. Errors are the
largest difference to direct sums in 80-bit arithmetic at 60 cells, relative to the largest density. mlpack and scikit-learn know
radial kernels only, which for the Gaussian is the same.
"""

import argparse
import json
import math
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
LOW, HIGH, CELLS = -4.0, 4.0, 256
STEP = (HIGH - LOW) / CELLS
ONE_THREAD = {name: "1" for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "RAYON_NUM_THREADS")}

# Name -> kernel, symmetry, engine, tolerance.
LAB = {
    "**lab** product Epanechnikov, planned": ("epanechnikov", "product", "auto", 1e-12),
    "**lab** product Epanechnikov, mesh": ("epanechnikov", "product", "mesh", 1e-12),
    "**lab** product Epanechnikov, splat": ("epanechnikov", "product", "splat", 1e-12),
    "**lab** radial Epanechnikov, splat": ("epanechnikov", "radial", "splat", 1e-12),
    "**lab** Gaussian, 1e-3": ("gaussian", "product", "auto", 1e-3),
    "**lab** Gaussian, planned": ("gaussian", "product", "auto", 1e-12),
    "**lab** Gaussian, splat": ("gaussian", "product", "splat", 1e-12),
}


def centres():
    import numpy as np

    return LOW + STEP * (np.arange(CELLS) + 0.5)


def places():
    import numpy as np

    x = centres()
    return np.stack(np.meshgrid(x, x, indexing="ij"), axis=-1).reshape(-1, 2)


def scikit_learn(kernel, h):
    from importlib.metadata import version

    import numpy as np
    from sklearn.neighbors import KernelDensity

    def estimate(points):
        return np.exp(KernelDensity(kernel=kernel, bandwidth=h, rtol=0.0, atol=0.0).fit(points).score_samples(places()))

    return version("scikit-learn"), estimate


def mlpack(kernel, h, relative):
    from importlib.metadata import version

    import numpy as np
    from mlpack import kde

    def estimate(points):
        answer = kde(reference=points, query=places(), kernel=kernel, bandwidth=h, rel_error=relative, abs_error=0.0,
                     tree="kd-tree", algorithm="dual-tree", copy_all_inputs=True)
        return np.asarray(answer["predictions"]).ravel()

    return version("mlpack"), estimate


def kdepy(kernel, h):
    """Its bandwidth is the deviation of the kernel along an axis; its kernels are products with norm 2: radial, as it computes them."""
    from importlib.metadata import version

    import numpy as np
    from KDEpy import FFTKDE

    deviation = h * {"gaussian": 1.0, "epa": 1.0 / math.sqrt(5.0)}[kernel]

    def estimate(points):
        # it wants all data within its grid: one of the same spacing, wide enough
        more = 2 * int(math.ceil((np.abs(points).max() + 0.1 - HIGH) / STEP)) if np.abs(points).max() >= HIGH - STEP else 0
        axis = LOW + STEP * (np.arange(-more, CELLS + more) + 0.5)
        grid = np.stack(np.meshgrid(axis, axis, indexing="ij"), axis=-1).reshape(-1, 2)
        values = FFTKDE(kernel=kernel, bw=deviation, norm=2).fit(points).evaluate(grid).reshape(len(axis), -1)
        return values[more : more + CELLS, more : more + CELLS].ravel()

    return version("KDEpy"), estimate


# Name -> function of h that gives (version, estimate), the kernel its answer is judged by.
PEERS = {
    "scikit-learn, radial Epanechnikov": (lambda h: scikit_learn("epanechnikov", h), "epanechnikov"),
    "scikit-learn, Gaussian": (lambda h: scikit_learn("gaussian", h), "gaussian"),
    "mlpack, radial Epanechnikov": (lambda h: mlpack("epanechnikov", h, 0.0), "epanechnikov"),
    "mlpack, radial Epanechnikov, 1e-4": (lambda h: mlpack("epanechnikov", h, 1e-4), "epanechnikov"),
    "KDEpy FFTKDE, Gaussian": (lambda h: kdepy("gaussian", h), "gaussian"),
    "KDEpy FFTKDE, Epanechnikov": (lambda h: kdepy("epa", h), "epanechnikov"),
}


def sample(n, file):
    import numpy as np

    np.random.Generator(np.random.PCG64(19860103)).standard_normal((n, 2)).tofile(file)


def exact(file, kernel, symmetry, h):
    """Direct sums in extended precision at some cells, among them those next to the middle."""
    import numpy as np

    points = np.fromfile(file).reshape(-1, 2)
    all_places = places()
    chosen = np.random.Generator(np.random.PCG64(7)).choice(len(all_places), 60, replace=False)
    middle = [(CELLS // 2 + i) * CELLS + CELLS // 2 + j for i in (-1, 0) for j in (-1, 0)]
    chosen = np.unique(np.concatenate([chosen, middle]))
    values = []
    for place in all_places[chosen]:
        reach = (10.0 if kernel == "gaussian" else 1.0) * h * (1 + 1e-12)
        near = points[(np.abs(points - place) <= reach).all(axis=1)].astype(np.longdouble)
        u, v = ((near - place.astype(np.longdouble)) / np.longdouble(h)).T
        if kernel == "gaussian":
            total = np.exp(-(u * u + v * v) / 2).sum() / (2 * np.longdouble("3.14159265358979323846"))
        elif symmetry == "radial":
            total = np.maximum(1 - (u * u + v * v), 0).sum() * 2 / np.longdouble("3.14159265358979323846")
        else:
            total = (np.maximum(1 - u * u, 0) * np.maximum(1 - v * v, 0)).sum() * np.longdouble(9) / 16
        values.append(float(total / np.longdouble(h) ** 2 / len(points)))
    return chosen.tolist(), values


def worker(name, file, h, answer):
    import numpy as np

    try:
        version, estimate = PEERS[name][0](h)
    except ImportError as error:
        return print(json.dumps({"status": f"not installed: {error}"}))
    points = np.fromfile(file).reshape(-1, 2)
    estimate(points[:1000].copy())
    wall, cpu = time.perf_counter(), time.process_time()
    values = estimate(points)
    cpu, wall = time.process_time() - cpu, time.perf_counter() - wall
    np.asarray(values, dtype=np.float64).tofile(answer)
    print(json.dumps({"status": "ok", "version": version, "cpu": cpu, "wall": wall}))


def run(call, limit=None):
    try:
        done = subprocess.run(
            [str(part) for part in call], capture_output=True, text=True, env=os.environ | ONE_THREAD, timeout=limit)
    except subprocess.TimeoutExpired:
        return None, f"stopped after {limit:.0f} s"
    return done.stdout if done.returncode == 0 else None, done.stderr


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--n", type=int, default=1_000_000)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--bandwidth", type=float, default=0.1)
    parser.add_argument("--limit", type=float, default=60.0, help="seconds after which a peer is stopped")
    parser.add_argument("--only", default="", help="only programs whose names hold this")
    parser.add_argument("--python", default=None, help="an interpreter with the peers; by default the pinned ones are installed")
    parser.add_argument("--lab", type=Path, default=None, help="the program peers-plane; by default it is built")
    parser.add_argument("--worker", nargs=4, help=argparse.SUPPRESS)
    parser.add_argument("--prepare", nargs=2, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.worker:
        name, file, h, answer = options.worker
        return worker(name, file, float(h), answer)
    if options.prepare:
        file, known = options.prepare
        sample(options.n, file)
        kinds = [("epanechnikov", "product"), ("epanechnikov", "radial"), ("gaussian", "product")]
        return Path(known).write_text(json.dumps({f"{k} {s}": exact(file, k, s, options.bandwidth) for k, s in kinds}))
    python = options.python
    if python is None:
        import environment

        environment.ensure()
        python = environment.PYTHON
    program = options.lab or build()
    with tempfile.TemporaryDirectory() as folder:
        file, known, answer = (Path(folder) / name for name in ("points", "known", "answer"))
        run_or_stop([python, __file__, "--n", options.n, "--bandwidth", options.bandwidth, "--prepare", file, known])
        truth = json.loads(known.read_text())
        rows, notes = {}, {}
        for number in range(options.rounds):
            for name in list(LAB) + list(PEERS):
                # long runs vary little and would hold up the rest
                if options.only not in name:
                    continue
                if name in notes or (number and rows[name]["cpu"][0] > 5):
                    continue
                if name in LAB:
                    kernel, symmetry, engine, tolerance = LAB[name]
                    text, error = run([program, file, kernel, symmetry, options.bandwidth, engine, tolerance, answer])
                    if text is None:
                        notes[name] = error.strip()
                        continue
                    cpu, wall, used = text.split()
                    record = {"cpu": float(cpu), "wall": float(wall), "version": used}
                else:
                    kernel = PEERS[name][1]
                    symmetry = "product" if kernel == "gaussian" else "radial"
                    text, error = run([python, __file__, "--worker", name, file, options.bandwidth, answer], options.limit)
                    record = json.loads(text.strip().splitlines()[-1]) if text else {"status": error.strip()[-200:]}
                    if record["status"] != "ok":
                        notes[name] = record["status"]
                        continue
                row = rows.setdefault(name, {"cpu": [], "wall": [], "version": record["version"]})
                row["cpu"].append(record["cpu"])
                row["wall"].append(record["wall"])
                row["error"] = difference(answer, *truth[f"{kernel} {symmetry}"])
                print(f"{name}: {record['cpu']:.4f} s, error {row['error']:.1e}", file=sys.stderr)
    print(f"n = {options.n:,}, {CELLS}² cells, h = {options.bandwidth}; load average {os.getloadavg()[0]:.1f}\n")
    print("| program | version or engine | CPU ms: median (min - max) | largest error / peak |")
    print("| --- | --- | --- | --- |")
    for name, row in sorted(rows.items(), key=lambda item: statistics.median(item[1]["cpu"])):
        ms = [1e3 * f(row["cpu"]) for f in (statistics.median, min, max)]
        print(f"| {name} | {row['version']} | {ms[0]:.1f} ({ms[1]:.1f} - {ms[2]:.1f}) | {row['error']:.1e} |")
    for name, note in notes.items():
        print(f"\nNo number for {name}: {note}")


def difference(answer, chosen, values):
    import array

    densities = array.array("d")
    densities.frombytes(answer.read_bytes())
    return max(abs(densities[i] - value) for i, value in zip(chosen, values)) / max(values)


def run_or_stop(call):
    text, error = run(call)
    if text is None:
        sys.exit(error)


def build():
    done = subprocess.run(["cargo", "build", "--release", "--locked", "--example", "peers-plane"], cwd=ROOT)
    if done.returncode != 0:
        sys.exit("peers-plane could not be built")
    return ROOT / "target" / "release" / "examples" / "peers-plane"


if __name__ == "__main__":
    main()
