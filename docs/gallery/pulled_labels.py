# SPDX-License-Identifier: Apache-2.0
"""A label map of numpy that is pulled: a soft organ with a stiff node and a fixed spine, made of arrays, becomes one
body. A part of its surface is pulled. Usage: python3 pulled_labels.py [FOLDER FOR THE PICTURE]"""

import pathlib
import sys

import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot as plt
import nibabel
import numpy as np

import c3de

out = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "out").resolve()
out.mkdir(parents=True, exist_ok=True)

# Millimetres in the frame of NIfTI: x to the right, y to the front, z to the head.
x, y, z = np.meshgrid(*[np.arange(-62.0, 63.0, 2.0)] * 3, indexing="ij")
organ = (x / 50)**2 + (y / 34)**2 + (z / 28)**2 < 1
node = (x - 18)**2 + y**2 + z**2 < 11**2
spine = (x + 34)**2 + (y + 26)**2 < 9**2
labels = np.zeros(x.shape, np.uint8)
labels[organ], labels[organ & node], labels[spine & (abs(z) < 50)] = 1, 2, 3
scan = 60.0 * organ + 40.0 * node * organ + 160.0 * (labels == 3) + 8 * np.sin(x / 4) * np.cos(y / 5) * organ
affine = np.diag([2.0, 2.0, 2.0, 1.0])
affine[:3, 3] = -62.0
nibabel.save(nibabel.Nifti1Image(labels, affine), out / "labels.nii.gz")
nibabel.save(nibabel.Nifti1Image(scan.astype(np.int16), affine), out / "scan.nii.gz")

scene = c3de.Scene("A label map that is pulled", solver={"damping": 20.0},  # 1/s
                   view={"surface": "hidden", "points": "none"},
                   image={"file": out / "scan.nii.gz", "labels": out / "labels.nii.gz", "still": {"labels": [3]}})
scene.add("body", name="organ", volume=out / "labels.nii.gz", sampling={"count": 3000}, tissues=[
    {"label": 1, "material": {"youngs_modulus": 4e3, "poisson_ratio": 0.45, "density": 1000.0}},
    {"label": 2, "material": {"youngs_modulus": 4e4, "poisson_ratio": 0.45, "density": 1000.0}},
    {"label": 3, "rigid": True}])

with scene.open(progress=True) as sim:
    body = sim.body("organ")
    skin = body.surface.vertices
    tip = skin[skin[:, 0].argmin()]  # metres in the frame of DICOM: -x is the right of the patient
    with body.hold(tip, radius=0.015) as hold:
        for part in np.linspace(0, 1, 20):
            hold.pull(tip + part * np.array([-0.02, 0, 0.012]))
            sim.run(until=sim.time + 0.05)
        print("pulled by %.1f mm with %.2f N" % (1e3 * np.linalg.norm(np.subtract(hold.point, tip)),
                                                 np.linalg.norm(hold.force)))
        u = body.points.field("displacement")
        print("largest displacement %.1f mm" % (1e3 * np.linalg.norm(u, axis=1).max()))
        space = sim.picture((450, 400), view="3d", up="z", camera=(-20, 15))  # surfaces of the tissues
        slices = sim.picture((450, 400), view="coronal", surface="opaque")
        plt.imsave(out / "pulled_labels.png", np.hstack([space, slices]))
