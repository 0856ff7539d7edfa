#!/usr/bin/env python3
"""The k-th neighbour at 256² places of a million points in the unit square: CPU seconds of `lab` and of k-d trees, and whether they agree.

    python3 benches/peers/neighbours.py [--n 1e6] [--k 50 500] [--threads 1] [--data even|spot] [--lab PROGRAM] [--kiddo PROGRAM]

Each number is the median over processes of their own that build and ask once, reading not counted. `lab` answers with the density
k/(n π d²), from which d is taken back; the others with the sorted list of k neighbours that they are made to give. kiddo, the k-d tree crate on which `lab` is built, too, is asked by
the example program `peers-neighbour`, one thread only. pynanoflann is a peer where it is installed (`pip install pynanoflann`); SciPy always is.
"""

import argparse
import json
import math
import os
import re
import resource
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

import environment

HERE = Path(__file__).resolve().parent
CACHE = HERE / ".cache"
SIDE = 256


def targets():
    import numpy as np

    centres = (np.arange(SIDE) + 0.5) / SIDE
    x, y = np.meshgrid(centres, centres, indexing="ij")
    return np.column_stack([x.ravel(), y.ravel()])


def points(kind, n):
    import numpy as np

    random = np.random.default_rng(1986)
    data = random.random((n, 2))
    if kind == "spot":  # half of them in a spot of a hundredth of the width
        data[::2] = np.clip(0.5 + 0.01 * random.standard_normal((len(data[::2]), 2)), 0.0, 1.0)
    return data


def scipy(data, where, k, threads):
    from scipy.spatial import cKDTree

    return cKDTree(data).query(where, k=[k], workers=threads)[0][:, 0]


def pynanoflann(data, where, k, threads):
    import pynanoflann as library

    tree = library.KDTree(n_neighbors=k, metric="L2", leaf_size=10)
    tree.fit(data)
    distances, _ = tree.kneighbors(where) if threads == 1 else tree.kneighbors(where, n_jobs=threads)
    return distances[:, -1]


PEERS = {"SciPy cKDTree": scipy, "pynanoflann": pynanoflann}
KIDDO = "kiddo nearest_n"


def work(name, data, answer, k, threads):
    """In a process of its own: one peer, once."""
    import numpy as np

    data, where = np.load(data), targets()
    try:
        PEERS[name](data[:1000], where[:10], min(k, 100), threads)  # imports and first calls
    except ImportError as error:
        print(json.dumps({"missing": str(error)}))
        return
    before = resource.getrusage(resource.RUSAGE_SELF)
    found = PEERS[name](data, where, k, threads)
    after = resource.getrusage(resource.RUSAGE_SELF)
    np.save(answer, found)
    print(json.dumps({"cpu": after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime}))


def lab(program, data, answer, k, threads):
    import numpy as np

    table = Path(answer).with_suffix(".csv")
    estimator = f'nearest-neighbour = {{ k = {k}, convention = "raw" }}'
    done = subprocess.run(
        [str(program), "estimate", str(data), "--column", "1", "--column", "2", "--estimator", estimator, f"--grid=0:1:{SIDE},0:1:{SIDE}",
         "--threads", str(threads), "--explain", "-o", str(table)],
        capture_output=True, text=True,
    )
    if done.returncode != 0:
        return {"missing": (done.stderr.strip().splitlines() or ["no message"])[0]}
    phases = dict((phase, float(cpu)) for phase, cpu in re.findall(r"^phase (\S+) wall \S+ cpu (\S+)", done.stdout + done.stderr, re.M))
    density = np.loadtxt(table, delimiter=",", skiprows=1)[:, -1]
    n = len(np.load(data, mmap_mode="r"))
    np.save(answer, np.sqrt(k / (n * math.pi * density)))
    return {"cpu": phases["fit"] + phases["evaluate"]}


def kiddo(program, data, answer, k):
    import numpy as np

    raw, found = (Path(answer).with_suffix(suffix) for suffix in (".points", ".distances"))
    np.load(data).tofile(raw)
    done = subprocess.run([str(program), str(raw), str(k), str(found)], capture_output=True, text=True)
    if done.returncode != 0:
        return {"missing": (done.stderr.strip().splitlines() or ["no message"])[0]}
    np.save(answer, np.fromfile(found))
    return {"cpu": float(done.stdout)}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--n", type=lambda text: int(float(text)), default=10**6)
    parser.add_argument("--k", type=int, nargs="+", default=[50, 500])
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--data", choices=("even", "spot"), default="even")
    parser.add_argument("--lab", type=Path, help="the program to measure; without it only the peers")
    parser.add_argument("--kiddo", type=Path, help="the program peers-neighbour (`cargo build --release --example peers-neighbour`); without it one peer less")
    parser.add_argument("--work", nargs=3, metavar=("NAME", "DATA", "ANSWER"), help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.work:
        return work(*options.work, options.k[0], options.threads)

    import numpy as np

    CACHE.mkdir(exist_ok=True)
    data = CACHE / f"square-{options.data}-{options.n}.npy"
    if not data.exists():
        np.save(data, points(options.data, options.n))
    print(f"| n = {options.n:,}, {SIDE}² places, {options.data}, {options.threads} thread(s) | k | CPU s | over fastest peer | largest difference of d |")
    print("|---|---|---|---|---|")
    for k in options.k:
        runs, answers = {}, {}
        for _ in range(options.rounds):
            for name in [*PEERS, *([KIDDO] if options.kiddo and options.threads == 1 else []), *(["**lab**"] if options.lab else [])]:
                with tempfile.TemporaryDirectory() as folder:
                    answer = Path(folder) / "answer.npy"
                    if name == "**lab**":
                        record = lab(options.lab, data, answer, k, options.threads)
                    elif name == KIDDO:
                        record = kiddo(options.kiddo, data, answer, k)
                    else:
                        command = [sys.executable, __file__, "--k", str(k), "--threads", str(options.threads), "--work", name, str(data), str(answer)]
                        record = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
                    runs.setdefault(name, []).append(record)
                    if "cpu" in record:
                        answers[name] = np.load(answer)
        cpu = {name: statistics.median(r["cpu"] for r in list) for name, list in runs.items() if "cpu" in list[0]}
        fastest = min((seconds for name, seconds in cpu.items() if name != "**lab**"), default=math.nan)
        for name, records in runs.items():
            if name not in cpu:
                print(f"| {name} | {k} | - | - | {records[0]['missing']} |")
                continue
            first = answers["SciPy cKDTree"]
            apart = float(np.max(np.abs(answers[name] / first - 1.0)))
            print(f"| {name} | {k} | {cpu[name]:.3f} | {cpu[name] / fastest:.2f} | {apart:.1e} |")


if __name__ == "__main__":
    if "--work" not in sys.argv and Path(sys.executable) != Path(environment.PYTHON):
        environment.ensure()
        os.execv(environment.PYTHON, [str(environment.PYTHON), *sys.argv])
    main()
