# SPDX-License-Identifier: Apache-2.0
"""The synthetic scan: its liver moves when the patient stands up. Slices before and after, how far the tumour moves, and how
that depends on the stiffness of the liver. Usage: python3 living_scan.py [FOLDER FOR THE PICTURE]"""

import pathlib
import sys

import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

import c3de

out = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "out")
out.mkdir(parents=True, exist_ok=True)
SCENE = c3de.resource("scenes/living_scan.toml")


def displacement(report):
    """Of the first probe, in mm: to the left, to the back, to the head."""
    probe = report["probes"][0]
    return 1e3 * np.subtract(probe["position_m"], probe["reference_m"])


with c3de.open(SCENE, progress=True) as sim:
    before = sim.warped_image()
    sim.run(until=3.0, progress=True)
    after = sim.warped_image(progress=True)
    tumour = displacement(sim.report())
print("the tumour moves by %.1f mm: left %.1f, back %.1f, up %.1f mm" % (np.linalg.norm(tumour), *tumour))

# The sagittal slice through the tumour, front to the left; the lines cross where the tumour is in the original scan.
figure, axes = plt.subplots(1, 3, figsize=(11, 4.0), layout="constrained", width_ratios=(1, 1, 1.1))
voxel = (np.linalg.inv(before.affine) @ [76, 26, 6, 1]).round().astype(int)[:3]
for ax, scan, title in zip(axes, (before, after), ("lying", "standing")):
    ax.imshow(scan.array[voxel[0]].T, cmap="gray", origin="lower", vmin=-160, vmax=240, aspect=4.0 / 2.9)
    ax.axhline(voxel[2], color="orange", linewidth=0.8)
    ax.axvline(voxel[1], color="orange", linewidth=0.8)
    ax.set_title(title)
    ax.axis("off")

stiffness = [3e3, 6e3, 12e3]  # Pa
rows = list(c3de.sweep(SCENE, {"body.liver.youngs_modulus": stiffness}, until=3.0, jobs=2))
moved = [np.linalg.norm(displacement(row.report)) for row in rows]
axes[2].plot([1e-3 * e for e in stiffness], moved, "o-")
axes[2].set(xlabel="Young's modulus of the liver (kPa)", ylabel="displacement of the tumour (mm)", ylim=(0, None))
figure.savefig(out / "living_scan.png", dpi=90)
