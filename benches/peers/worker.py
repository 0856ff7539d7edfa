"""One program, one question, once, in a process of its own: `worker.py PROGRAM WORK DATA.npy ANSWER.npy`.

Prints one line of JSON: CPU and wall seconds of the estimation alone (the data are in memory, imports are done
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
    from work import WORKS

    try:
        version, estimate = PROGRAMS[name][0](WORKS[work_name])
    except ImportError as error:
        return report(status="not installed", detail=str(error))

    x = np.load(data)
    # A grid narrower than the data is refused by some: take the warm-up from the file itself.
    estimate(x[:1000].copy())
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    wall, cpu = time.perf_counter(), time.process_time()
    result = estimate(x)
    cpu, wall = time.process_time() - cpu, time.perf_counter() - wall
    after = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    np.save(answer, np.asarray(result, dtype=np.float64).ravel())
    report(
        status="ok", version=version, cpu=cpu, wall=wall, peak=after * 1024, extra=(after - before) * 1024,
    )


def report(**fields):
    print(json.dumps(fields))


if __name__ == "__main__":
    main()
