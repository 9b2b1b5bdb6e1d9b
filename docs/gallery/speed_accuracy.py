# SPDX-License-Identifier: Apache-2.0
"""Speed against accuracy: the cantilever with finer and finer sampling. The error is that of the tip, compared with
extrapolated finite elements. Usage: python3 speed_accuracy.py [FOLDER FOR THE PICTURE]"""

import pathlib
import sys

import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot as plt

import c3de

out = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "out")
out.mkdir(parents=True, exist_ok=True)

TRUTH = -0.0150084523  # m, CalculiX 2.20, extrapolated; uncertainty 5e-6 m
SPACINGS = [0.02, 0.0133333, 0.01, 0.00666667, 0.005]  # m, two to eight cells across the beam
points, milliseconds, errors = [], [], []
for row in c3de.sweep(c3de.resource("scenes/cantilever.toml"), {"body.beam.sampling.spacing": SPACINGS}):
    if row.error:
        raise row.error
    points.append(row.report["bodies"][0]["phyxels"])
    milliseconds.append(1e3 * row.report["wall_s"])
    errors.append(100 * abs(row.report["probes"][0]["position_m"][2] / TRUTH - 1))
    print("%5d points: %7.1f ms, error %.3f %%" % (points[-1], milliseconds[-1], errors[-1]))

figure, axes = plt.subplots(figsize=(6.4, 4), layout="constrained")
axes.plot(milliseconds, errors, "o-")
for count, x, y in zip(points, milliseconds, errors):
    axes.annotate("%d points" % count, (x, y), (6, 4), textcoords="offset points")
axes.set(xscale="log", xlabel="time for the solution in ms", ylabel="error of the tip in %", ylim=(0, 1.2 * max(errors)))
axes.margins(x=0.25)
axes.grid(alpha=0.3, which="both")
figure.savefig(out / "speed_accuracy.png", dpi=90)
