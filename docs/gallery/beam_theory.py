# SPDX-License-Identifier: Apache-2.0
"""Beam against theory: a beam that is held at one end sags under its own weight. Its deflection is compared with that
of Timoshenko's beam theory. Usage: python3 beam_theory.py [FOLDER FOR THE PICTURE]"""

import pathlib
import sys

import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

import c3de

out = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "out")
out.mkdir(parents=True, exist_ok=True)

L, A, E, NU, RHO, G = 0.2, 0.02, 5e7, 0.3, 1000.0, 9.81  # m, m, Pa, 1, kg/m³, m/s²
corners = [[x, y, z] for x in (0, L) for y in (-A / 2, A / 2) for z in (-A / 2, A / 2)]
faces = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
         [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]
scene = c3de.Scene("Beam under its own weight", world={"gravity": [0, 0, -G]}, solver={"integrator": "quasistatic"})
scene.body("beam", corners, faces, material={"youngs_modulus": E, "poisson_ratio": NU, "density": RHO},
           sampling={"spacing": A / 4})
scene.fix("beam", {"box": {"min": [-1e-6, -1, -1], "max": [1e-6, 1, 1]}})

with scene.open() as sim:
    points = sim.run().body("beam").points
    rest, u = points.field("reference_position"), points.field("displacement")
    picture = sim.picture((640, 480), colour="displacement", up="z", camera=(-35, 15))

# The mean over each cross-section of the lattice of points.
x = np.unique(rest[:, 0].round(6))
sag = np.array([u[np.isclose(rest[:, 0], one, atol=1e-6), 2].mean() for one in x])

# Bending and shear under q = rho g A², in N/m.
q, inertia, shear = RHO * G * A**2, A**4 / 12, E / (2 * (1 + NU)) * A**2 * 10 * (1 + NU) / (12 + 11 * NU)
s = np.linspace(0, L, 100)
bending = -q * s**2 * (6 * L**2 - 4 * L * s + s**2) / (24 * E * inertia)
theory = bending - q * (L * s - s**2 / 2) / shear
difference = 100 * (sag[-1] / theory[-1] - 1)
print("tip: %.4f mm, theory %.4f mm, difference %.2f %%" % (1e3 * sag[-1], 1e3 * theory[-1], difference))

figure, (left, right) = plt.subplots(1, 2, figsize=(10, 3.8), layout="constrained")
left.imshow(picture)
left.axis("off")
right.plot(1e3 * s, 1e3 * theory, "-", color="0.4", label="Timoshenko beam")
right.plot(1e3 * x, 1e3 * sag, "o", ms=4, label="C3DE, %d points" % len(rest))
right.set(xlabel="position along the beam in mm", ylabel="deflection in mm", title="difference at the tip: %.2f %%" % difference)
right.legend()
figure.savefig(out / "beam_theory.png", dpi=90)
