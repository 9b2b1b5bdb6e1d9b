# SPDX-License-Identifier: Apache-2.0
"""Brain shift: a brain shifts in its head when fluid runs off. The deformed scan is drawn beside the scan. Needs the
scan of the Debian package mricron-data. Usage: python3 brain_shift.py [FOLDER FOR THE PICTURE]"""

import pathlib
import sys

import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot as plt
import nibabel
import numpy as np

import c3de

SCAN = "/usr/share/mricron/templates/ch2.nii.gz"
out = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "out")
out.mkdir(parents=True, exist_ok=True)

with c3de.open(c3de.resource("scenes/brain_shift.toml"), progress=True) as sim:
    sim.run(until=3.0, progress=True)
    u = 1e3 * np.linalg.norm(sim.body("brain").points.field("displacement"), axis=1)
    print("displacement: mean %.1f mm, largest %.1f mm" % (u.mean(), u.max()))
    after = sim.warped_image(progress=True).array
before = nibabel.load(SCAN)

# The sagittal slice in the middle of the head, front to the left.
middle = int((np.linalg.inv(before.affine) @ [0, 0, 0, 1])[0].round())
slices = [values[middle].T[:, ::-1] for values in (before.get_fdata(), after.astype(float))]
figure, axes = plt.subplots(1, 3, figsize=(11, 3.2), layout="constrained")
for ax, values, title in zip(axes, slices, ("scan", "after the shift")):
    ax.imshow(values, cmap="gray", origin="lower", vmin=0, vmax=slices[0].max())
    ax.set_title(title)
shown = axes[2].imshow(slices[1] - slices[0], cmap="RdBu", origin="lower", vmin=-100, vmax=100)
axes[2].set_title("difference of grey values")
figure.colorbar(shown, ax=axes[2], shrink=0.8)
for ax in axes:
    ax.axis("off")
figure.savefig(out / "brain_shift.png", dpi=90)
