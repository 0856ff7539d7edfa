"""How `lab` is asked the same questions, and how its own account of the time is read."""

import json
import os
import re
import subprocess
import tempfile
from pathlib import Path

from work import CELLS, HIGH, LOW, REPEATS

# Name in the table -> the works it can do, the engine it is told to use and its threads.
GRIDS = ("gaussian-grid", "epanechnikov-grid")
ROWS = {
    "**lab** histogram": (("histogram",), None, 1),
    "**lab** histogram, 2 threads": (("histogram",), None, 2),
    "**lab** binned, 1e-4": (("gaussian-grid",), "binned", 1, 1e-4),
    "**lab** binned, 1e-4, 2 threads": (("gaussian-grid",), "binned", 2, 1e-4),
    "**lab** binned, 1e-6": (("gaussian-grid",), "binned", 1, 1e-6),
    "**lab** hermite, 1e-6": (("gaussian-grid",), "hermite", 1, 1e-6),
    "**lab** hermite, 1e-10": (("gaussian-grid",), "hermite", 1, 1e-10),
    "**lab** hermite": (("gaussian-grid", "gaussian-points"), "hermite", 1),
    "**lab** hermite, 2 threads": (("gaussian-grid", "gaussian-points"), "hermite", 2),
    "**lab** moments": (("epanechnikov-grid",), "interval", 1),
    "**lab** moments, 2 threads": (("epanechnikov-grid",), "interval", 2),
    "**lab** sorted": (("epanechnikov-grid", "epanechnikov-points"), "sorted", 1),
    "**lab** sorted, 2 threads": (("epanechnikov-grid", "epanechnikov-points"), "sorted", 2),
}


def command(program, name, work, data, answer):
    _, engine, threads, *tolerance = ROWS[name]
    if work.at == "bins":
        estimator = f"histogram = {{ width = {(HIGH - LOW) / CELLS}, origin = {LOW} }}"
    else:
        exactness = "".join(f", tolerance = {tolerance}" for tolerance in tolerance)
        estimator = f'kernel = {{ shape = "{work.kernel}", bandwidth = {work.bandwidth}{exactness} }}'
    places = ["--at", str(data)] if work.at == "points" else [f"--grid={LOW:g}:{HIGH:g}:{CELLS}"]
    engine = ["--engine", engine] if engine else []
    return [
        str(program), "estimate", str(data), "--estimator", estimator, *engine, *places,
        "--threads", str(threads), "--repeat", str(REPEATS), "--explain", "-o", str(answer),
    ]


def measure(program, name, work, data, answer):
    """Runs `lab` once. The estimation is its phases `fit` and `evaluate`, the median of their repetitions; reading and writing are not counted."""
    table = Path(answer).with_suffix(".csv")
    with tempfile.TemporaryFile("w+") as log:
        process = subprocess.Popen(
            command(program, name, work, data, table), stdin=subprocess.DEVNULL, stdout=log, stderr=log, text=True
        )
        # wait4 gives this child's own peak memory; a time limit is not needed: lab is never the slow one.
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        log.seek(0)
        text = log.read()
    if process.returncode != 0:
        return {"status": "failed", "detail": text.strip().splitlines()[-1] if text.strip() else "no message"}
    phases = {"fit": [], "evaluate": []}
    for phase, wall, cpu in re.findall(r"^phase (\S+) wall (\S+) cpu (\S+)", text, re.MULTILINE):
        phases.setdefault(phase, []).append((float(wall), float(cpu)))
    if not phases["fit"] or len(phases["fit"]) != len(phases["evaluate"]):
        return {"status": "failed", "detail": "no phases in the output of --explain"}
    runs = sorted((fit[1] + sums[1], fit[0] + sums[0]) for fit, sums in zip(phases["fit"], phases["evaluate"]))
    cpu, wall = runs[(len(runs) - 1) // 2]
    densities(table, answer, work, data)
    return {
        "status": "ok", "version": version(program), "cpu": cpu, "wall": wall, "peak": usage.ru_maxrss * 1024,
        "extra": None, "phases": phases,
    }


def densities(table, answer, work, data):
    """The density column as .npy, turned back into counts for the histogram. In a process of its own: the runner stays small."""
    script = (
        "import sys, numpy as np; table, answer, scale = sys.argv[1:]; "
        "np.save(answer, np.loadtxt(table, delimiter=',', skiprows=1)[:, -1] * float(scale))"
    )
    scale = 1.0
    if work.at == "bins":
        scale = count(data) * (HIGH - LOW) / CELLS
    from environment import PYTHON

    subprocess.run([PYTHON, "-c", script, str(table), str(answer), repr(scale)], check=True)


def count(data):
    """The number of values of a .npy file of doubles, from its size."""
    with open(data, "rb") as file:
        start = file.read(10)
    return (os.path.getsize(data) - 10 - int.from_bytes(start[8:10], "little")) // 8


def version(program):
    text = subprocess.run([str(program), "--version"], capture_output=True, text=True).stdout.split()
    return text[-1] if text else "?"


def build(root):
    """`cargo build --release`; the path of the program, or None with a reason."""
    done = subprocess.run(
        ["cargo", "build", "--release", "--locked", "--bin", "lab", "--message-format=json-render-diagnostics"],
        cwd=root, stdout=subprocess.PIPE, text=True,
    )
    if done.returncode != 0:
        return None
    for line in done.stdout.splitlines():
        message = json.loads(line)
        if message.get("executable") and message.get("target", {}).get("name") == "lab":
            return Path(message["executable"])
    return None
