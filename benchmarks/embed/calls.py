# SPDX-License-Identifier: Apache-2.0
"""What calls of the Python package cost:

    PYTHONPATH=$(build/release/bin/c3de python-path) python3 benchmarks/embed/calls.py

A body of about 3 000 points, one thread; the median of many, in µs. Arrays need numpy.
"""

import argparse
import pathlib
import statistics
import time

import c3de

ORGAN = pathlib.Path(__file__).resolve().parents[2] / "resources" / "meshes" / "organ.obj"
SCENE = """format = 1
[world]
gravity = [0.0, 0.0, 0.0]
[[body]]
name = "organ"
mesh = "%s"
mesh_unit = "mm"
angular_velocity = [0.0, 30.0, 10.0]
sampling = { count = %d }
"""


def median_us(call, seconds):
    times = []
    end = time.perf_counter() + seconds
    while len(times) < 200 or time.perf_counter() < end:
        begin = time.perf_counter()
        call()
        times.append(1e6 * (time.perf_counter() - begin))
    return statistics.median(times)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--points", type=int, default=3000)
    parser.add_argument("--seconds", type=float, default=0.5, help="per measurement")
    options = parser.parse_args()
    with c3de.open(text=SCENE % (ORGAN, options.points), threads=1) as sim:
        body = sim.body("organ")
        sim.step(3)
        calls = [("sim.status", lambda: sim.status), ("sim.time", lambda: sim.time),
                 ('sim["body.organ.youngs_modulus"]', lambda: sim["body.organ.youngs_modulus"]),
                 ('sim.body("organ")', lambda: sim.body("organ")), ("body.mass", lambda: body.mass)]
        try:
            import numpy  # noqa: F401
        except ImportError:
            print("numpy is not installed: arrays are not measured")
        else:
            calls.append(('body.points.field("position")', lambda: body.points.field("position")))
        print("%d points" % len(body.points))
        for name, call in calls:
            print("%-36s %8.2f µs" % (name, median_us(call, options.seconds)))
        # In turns with the function of the library.
        library, times = c3de._library.lib, ([], [])
        steps = [sim.step, lambda: c3de._library.check(library.c3de_embed_step(sim._handle, 1, None))]
        end = time.perf_counter() + 4 * options.seconds
        while len(times[0]) < 200 or time.perf_counter() < end:
            for one in (0, 1) if len(times[0]) % 2 else (1, 0):
                begin = time.perf_counter()
                steps[one]()
                times[one].append(1e6 * (time.perf_counter() - begin))
        beyond = statistics.quantiles(times[0], n=10)[0] - statistics.quantiles(times[1], n=10)[0]
        print("%-36s %8.2f µs" % ("sim.step(), beyond c3de_embed_step()", beyond))


if __name__ == "__main__":
    main()
