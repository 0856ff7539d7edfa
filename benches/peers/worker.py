"""One program, one question, in a process of its own: `worker.py PROGRAM WORK DATA.npy ANSWER.npy`.

Prints one line of JSON: CPU and wall seconds of the estimation alone, the median of a few (the data are in memory, imports are done
and a thousand points have gone through before), the peak memory, and the program's version.
"""

import json
import resource
import sys
import time


def main():
    name, work_name, data, answer = sys.argv[1:]
    import numpy as np

    from programs import PROGRAMS
    from work import ENOUGH, REPEATS, WORKS

    try:
        version, estimate = PROGRAMS[name][0](WORKS[work_name])
    except ImportError as error:
        return report(status="not installed", detail=str(error))

    x = np.load(data)
    # A grid narrower than the data is refused by some: take the warm-up from the file itself.
    estimate(x[:1000].copy())
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    runs = []
    while len(runs) < REPEATS and sum(wall for _, wall in runs) < ENOUGH:
        wall, cpu = time.perf_counter(), time.process_time()
        result = estimate(x)
        runs.append((time.process_time() - cpu, time.perf_counter() - wall))
    # of an even number the lower middle one, so that CPU and wall time belong together
    cpu, wall = sorted(runs)[(len(runs) - 1) // 2]
    after = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    np.save(answer, np.asarray(result, dtype=np.float64).ravel())
    report(
        status="ok", version=version, cpu=cpu, wall=wall, peak=after * 1024, extra=(after - before) * 1024,
    )


def report(**fields):
    print(json.dumps(fields))


if __name__ == "__main__":
    main()
