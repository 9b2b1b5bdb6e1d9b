# SPDX-License-Identifier: Apache-2.0
"""Brain shift: a brain settles in its head when fluid runs off. The deformed scan is drawn beside the scan. Needs the scan
of the Debian package mricron-data. Usage: python3 brain_shift.py [FOLDER FOR THE PICTURE]"""

import pathlib
import subprocess
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
    sim.save_session(out / "brain_shift.c3de")

subprocess.run([c3de.program(), "run", str(out / "brain_shift.c3de"), "--steps", "0", "-q", "--export-image",
                str(out / "brain_shift.nii.gz")], check=True)
before, after = nibabel.load(SCAN), nibabel.load(out / "brain_shift.nii.gz")

# The sagittal slice in the middle of the head, front to the left.
middle = int((np.linalg.inv(before.affine) @ [0, 0, 0, 1])[0].round())
slices = [image.get_fdata()[middle].T[:, ::-1] for image in (before, after)]
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
