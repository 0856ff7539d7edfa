#!/usr/bin/env python3
"""Runs `lab` and its peers on the same files, in turn, and prints time, error and ratio as Markdown tables.

Needs Python 3.11 or newer and nothing else; see README.md for what is measured and how it may mislead.
"""

import argparse
import json
import math
import os
import platform
import shutil
import statistics
import subprocess
import sys
import time
from pathlib import Path

import environment
import lab
from work import CELLS, ENOUGH, EXACT, HIGH, LOW, REPEATS, WORKS

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
CACHE = HERE / ".cache"
R_ROWS = {"R density": lab.GRIDS, "R KernSmooth bkde": lab.GRIDS, "R hist": ("histogram",)}

TWO = ", 2 threads"

# One thread unless the row says otherwise: these libraries would take all cores unasked.
ONE_THREAD = {
    name: "1" for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "BLIS_NUM_THREADS", "NUMEXPR_NUM_THREADS")
}


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--n", type=lambda text: int(float(text)), nargs="+", help="sample sizes (default 1e5 1e6 1e7)")
    parser.add_argument("--data", choices=("normal", "bimodal"), default="normal", help="what the samples are drawn from")
    parser.add_argument("--works", nargs="+", choices=list(WORKS), default=list(WORKS), help="the questions asked")
    parser.add_argument("--programs", nargs="+", metavar="PART", help="only programs whose name contains one of these")
    parser.add_argument("--rounds", type=int, help="how often each is run (default 7; slow ones less)")
    parser.add_argument("--budget", type=float, help="skip a run that would take more CPU seconds than this (default 60)")
    parser.add_argument("--quick", action="store_true", help="n = 1e5 and 1e6, two rounds, budget 1.5 s: under two minutes")
    parser.add_argument("--lab", type=Path, help="the program to measure (default: cargo build --release)")
    parser.add_argument("--no-lab", action="store_true", help="peers only")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write every single run there")
    options = parser.parse_args()
    options.n = sorted(options.n or ([10**5, 10**6] if options.quick else [10**5, 10**6, 10**7]))
    options.rounds = options.rounds or (2 if options.quick else 7)
    options.budget = options.budget or (1.5 if options.quick else 60.0)
    return options


def main():
    options = arguments()
    environment.ensure()
    CACHE.mkdir(exist_ok=True)
    os.environ.update(ONE_THREAD)
    program = None if options.no_lab else options.lab or lab.build(ROOT)
    if program is None and not options.no_lab:
        print("`cargo build --release` gave no `lab`: its rows are left out", file=sys.stderr)

    bench = Bench(options, program)
    started = time.strftime("%Y-%m-%d %H:%M UTC", time.gmtime())
    for n in options.n:
        bench.size(n)
    print(heading(started, options))
    for work in options.works:
        for n in options.n:
            print(bench.table(work, n))
    if options.json:
        options.json.write_text(json.dumps({"started": started, "machine": machine(), "runs": bench.runs}, indent=1))


class Bench:
    """All runs of one invocation."""

    def __init__(self, options, program):
        self.options = options
        self.program = program
        self.runs = []  # one record per process started
        self.notes = {}  # (work, n, name) -> why there is no number

        # Name -> the works it can do.
        self.programs = json.loads(python("programs.py")) | R_ROWS
        if program:
            self.programs |= {name: works for name, (works, *_) in lab.ROWS.items()}
        if options.programs:
            self.programs = {name: works for name, works in self.programs.items() if any(part in name for part in options.programs)}

    def size(self, n):
        """Every program and question at one sample size: round by round, one after the other."""
        data = CACHE / f"{self.options.data}-{n}.npy"
        cached(data, "data", self.options.data, n)
        for number in range(self.options.rounds):
            for work in self.options.works:
                known = CACHE / f"{work}-{data.stem}.npz"
                cached(known, "exact", work, data)
                # Each round begins elsewhere, so that nobody always follows the same neighbour.
                for name in rotated([name for name, works in self.programs.items() if work in works], number):
                    if self.due(work, n, name, number):
                        self.one(WORKS[work], n, name, data, known)

    def due(self, work, n, name, number):
        if (work, n, name) in self.notes:
            return False
        spent = [run["cpu"] for run in self.of(work, n, name)]
        if spent:
            # Long runs vary little and would hold up the rest.
            share = spent[0] / self.options.budget
            rounds = 1 if share > 0.1 else 3 if share > 0.02 else self.options.rounds
            return number < rounds and not (self.options.quick and self.far_behind(work, n, spent[0]))
        earlier = [note for size in self.options.n if size < n and (note := self.notes.get((work, size, name)))]
        if earlier:
            self.notes[work, n, name] = earlier[-1].split(": about")[0]
            return False
        guess = self.guess(work, n, name)
        if guess > self.options.budget:
            self.notes[work, n, name] = f"skipped: about {guess:,.0f} s"
            return False
        return True

    def far_behind(self, work, n, cpu):
        return cpu > 20 * min(run["cpu"] for run in self.runs if (run["work"], run["n"]) == (work, n))

    def guess(self, work, n, name):
        """CPU seconds to expect: the power of n seen at the last two sizes, continued."""
        seen = [(size, statistics.median(run["cpu"] for run in runs)) for size in self.options.n if size < n
                if (runs := self.of(work, size, name))]
        if not seen:
            if WORKS[work].at != "points":
                return 0.0
            # Some sum every pair, so that a blind first run could take hours.
            sizes = (n // 10,) if self.options.quick else (n // 100, n // 10)
            seen = [(size, cpu) for size in sizes if (cpu := self.pilot(work, size, name))]
        if len(seen) < 2:
            power = 2 if WORKS[work].at == "points" else 1
            return seen[-1][1] * (n / seen[-1][0]) ** power if seen else 0.0
        (small, less), (large, more) = seen[-2:]
        power = math.log(more / less) / math.log(large / small)
        return more * (n / large) ** max(power, 0.5)

    def pilot(self, work, n, name):
        data = CACHE / f"{self.options.data}-{n}.npy"
        cached(data, "data", self.options.data, n)
        return self.start(WORKS[work], name, data, CACHE / "pilot.npy").get("cpu", 0.0)

    def one(self, work, n, name, data, known):
        answer = CACHE / ("answer.f64" if name in R_ROWS else "answer.npy")
        record = self.start(work, name, data, answer)
        if record["status"] != "ok":
            self.notes[work.name, n, name] = ": ".join(filter(None, (record["status"], record.get("detail"))))
        else:
            before = self.of(work.name, n, name)
            # The same program gives the same answer again; the first one is judged.
            error = before[0]["error"] if before else float(python("reference.py", "error", answer, known))
            record |= {"work": work.name, "n": n, "data": self.options.data, "program": name, "error": error}
            self.runs.append(record)
            print(f"{work.name} n={n} {name}: {ms(record['cpu'])} ms, error {record['error']:.1e}", file=sys.stderr)

    def start(self, work, name, data, answer):
        limit = 60 + 6 * self.options.budget
        if name in lab.ROWS:
            return lab.measure(self.program, name, work, data, answer)
        if name in R_ROWS:
            if shutil.which("Rscript") is None:
                return {"status": "not installed"}
            call = ["Rscript", "--vanilla", "worker.R", name, work.at, data, answer, LOW, HIGH, CELLS, work.kernel, work.bandwidth, REPEATS, ENOUGH]
        else:
            call = [environment.PYTHON, "worker.py", name, work.name, data, answer]
        try:
            done = subprocess.run([str(part) for part in call], cwd=HERE, capture_output=True, text=True, timeout=limit)
        except subprocess.TimeoutExpired:
            return {"status": f"stopped after {limit:.0f} s"}
        if done.returncode != 0:
            return {"status": "failed", "detail": (done.stderr.strip().splitlines() or ["no message"])[-1]}
        return json.loads(done.stdout.strip().splitlines()[-1])

    def of(self, work, n, name):
        return [run for run in self.runs if (run["work"], run["n"], run["program"]) == (work, n, name)]

    def table(self, work, n):
        """One question at one size, fastest first; each ratio is to the fastest peer of the same class."""
        rows = [summary(name, runs) for name in self.programs if (runs := self.of(work, n, name))]
        rows.sort(key=lambda row: row["cpu"])
        best = {}
        for row in rows:
            if not row["ours"]:
                best.setdefault(row["exact"], row["cpu"])
        lines = [
            f"### {WORKS[work].title}, n = {n:,}\n",
            "| program | version | CPU ms: median (min - max) | wall ms | largest error / peak | ratio to best peer | peak memory, MiB |",
            "| --- | --- | --- | --- | --- | --- | --- |",
        ]
        for row in rows:
            peer = best.get(row["exact"])
            ratio = f"{row['cpu'] / peer:.2f} ({'exact' if row['exact'] else 'approximate'})" if peer else "no such peer"
            lines.append(
                f"| {row['name']} | {row['version']} | {ms(row['cpu'])} ({ms(row['low'])} - {ms(row['high'])}) | {ms(row['wall'])} "
                f"| {row['error']:.1e} | {ratio} | {row['peak'] / 2**20:.0f} |"
            )
        walls = {row["name"]: row["wall"] for row in rows}
        faster = [f"{name} {walls[name] / wall:.2f}×" for two, wall in walls.items()
                  if (name := two.removesuffix(TWO)) != two and name in walls]
        if faster:
            lines.append(f"\nTwo threads against one, wall time: {'; '.join(faster)}.")
        without = [f"{name} ({note})" for (of, size, name), note in self.notes.items() if (of, size) == (work, n)]
        if without:
            lines.append(f"\nNo number: {'; '.join(without)}.")
        return "\n".join(lines) + "\n"


def summary(name, runs):
    cpu = [run["cpu"] for run in runs]
    error = max(run["error"] for run in runs)
    return {
        "name": name, "ours": name in lab.ROWS, "version": runs[0]["version"],
        "cpu": statistics.median(cpu), "low": min(cpu), "high": max(cpu),
        "wall": statistics.median(run["wall"] for run in runs),
        "error": error, "exact": error <= EXACT, "peak": max(run["peak"] for run in runs),
    }


def ms(seconds):
    """Three digits of milliseconds."""
    value = seconds * 1e3
    return f"{value:,.0f}" if value >= 100 else f"{value:.1f}" if value >= 10 else f"{value:.2f}"


def rotated(names, by):
    by = by * 5 % max(len(names), 1)
    return names[by:] + names[:by]


def cached(file, *call):
    if not file.exists():
        draft = file.with_name("draft" + file.suffix)
        python("reference.py", *call, draft)
        draft.rename(file)


def python(*call):
    done = subprocess.run([environment.PYTHON, *map(str, call)], cwd=HERE, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, call))}\n{done.stderr}")
    return done.stdout


def machine():
    model = platform.processor() or platform.machine()
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        model = next(line.split(":", 1)[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        pass
    return f"{model}, {os.cpu_count()} cores, {platform.system()}, Python {platform.python_version()}"


def heading(started, options):
    shown = " ".join(Path(word).name if os.sep in word else word for word in sys.argv)
    return (
        f"`{shown}` on {machine()}; {started}; load average before the tables {os.getloadavg()[0]:.1f}. "
        f"Data: {options.data}; up to {options.rounds} rounds, interleaved; one thread unless the row says two. "
        f"Exact: within {EXACT:g} of the peak.\n"
    )


if __name__ == "__main__":
    main()
