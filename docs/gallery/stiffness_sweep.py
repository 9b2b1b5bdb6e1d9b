# SPDX-License-Identifier: Apache-2.0
"""Sag against stiffness: the same cantilever with seven values of Young's modulus. The error bars are the program's own
estimates. Usage: python3 stiffness_sweep.py [FOLDER FOR THE PICTURE]"""

import pathlib
import sys

import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

import c3de

out = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "out")
out.mkdir(parents=True, exist_ok=True)

values = np.geomspace(2e5, 2e7, 7)  # Pa
sweep = c3de.sweep(c3de.resource("scenes/cantilever.toml"),
                   {"body.beam.youngs_modulus": values, "body.beam.sampling.spacing": [0.0133333]}, jobs=2)
sag, error = [], []
for row in sweep:
    if row.error:
        raise row.error
    tip = row.report["probes"][0]
    sag.append(tip["reference_m"][2] - tip["position_m"][2])
    error.append(row.report["bodies"][0]["accuracy_statement"]["displacement_error_m"])
    print("%8.0f kPa: sag %7.3f mm, estimated error %.3f mm"
          % (row.values["body.beam.youngs_modulus"] / 1e3, 1e3 * sag[-1], 1e3 * error[-1]))

sag, error = 1e3 * np.array(sag), 1e3 * np.array(error)  # mm

# The stiffest beam bends least: from it, small displacements are inversely proportional to the stiffness.
linear = sag[-1] * values[-1] / values
figure, (left, right) = plt.subplots(1, 2, figsize=(10, 3.8), layout="constrained")
left.plot(values / 1e3, linear, "--", color="0.5", label="proportional to 1/E")
left.plot(values / 1e3, sag, "o-", ms=4, label="C3DE")
left.set(xscale="log", yscale="log", xlabel="Young's modulus in kPa", ylabel="sag of the tip in mm")
right.axhline(100, ls="--", color="0.5")
right.errorbar(values / 1e3, 100 * sag / linear, 100 * error / linear, fmt="o-", ms=4, capsize=4,
               label="with the estimated error")
right.set(xscale="log", xlabel="Young's modulus in kPa", ylabel="sag in % of that proportional to 1/E")
for axes in left, right:
    axes.grid(alpha=0.3)
    axes.legend()
figure.savefig(out / "stiffness_sweep.png", dpi=90)
