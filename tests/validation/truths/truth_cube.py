#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The Truth Cube as a reference: resources/studies/eight/truth_cube.csv from two scans of its beads.

A. E. Kerdok et al., Truth Cube: Establishing Physical Standards for Real Time Soft Tissue Simulation, Medical Image Analysis
7 (2003) 283-291: 7 x 7 x 7 beads, 10 mm apart, in a cube of silicone gel of 80 mm on a base, CT before and under a plate.

    truth_cube.py uncompressed.csv compressed_18_25.csv truth_cube.csv

Rows x,y,z in mm, z fastest, from the base to the plate, as they stand in OpenSurgSim, SurgSim/Physics/RenderTests/Data. Needs
numpy.
"""
import itertools
import sys

import numpy as np

HALF = 40.0     # mm, of the cube
FOOT = 0.44     # mm, how far the second scan lies towards the base: the middle of what estimate() says
BEAD = 0.12     # mm, of the mean of eight beads, per component
VOLUME = 0.01   # of J


def read(path):
    return np.loadtxt(path, delimiter=",", comments="#").reshape(7, 7, 7, 3)


def mirrored(f):
    """The eight images of a vector field under x -> -x, y -> -y, x <-> y."""
    images = []
    for flip_x, flip_y, swap in itertools.product((False, True), repeat=3):
        g = f.copy()
        if flip_x:
            g = g[::-1] * (-1, 1, 1)
        if flip_y:
            g = g[:, ::-1] * (1, -1, 1)
        if swap:
            g = g.swapaxes(0, 1)[..., [1, 0, 2]]
        images.append(g)
    return np.array(images)


def levelled(u, x):
    """Without what moves or tilts a layer of beads as a whole sideways: the plate drifted, and no mean of images feels it."""
    out = u.copy()
    for k in range(7):
        out[:, :, k, :2] -= u[:, :, k, :2].mean((0, 1))
        place = x[:, :, k, :2].reshape(-1, 2)
        place = place - place.mean(0)
        height = u[:, :, k, 2].ravel()
        tilt = np.linalg.lstsq(place, height - height.mean(), rcond=None)[0]
        out[:, :, k, 2] -= (place @ tilt).reshape(7, 7)
    return out


def columns(x, y, s, order, along):
    """u_z: rigid foot (s = 0) and plate (s = 1); u_x, u_y: the foot holds, the plate may spread them. With derivatives."""
    zero = np.zeros((4, s.size))

    def term(a, b, f, df):
        def d(p, n):
            return n * p ** (n - 1) if n else 0 * p
        return np.stack([x ** a * y ** b * f, d(x, a) * y ** b * f, x ** a * d(y, b) * f, x ** a * y ** b * df])

    powers = [(a, b) for a in range(order + 1) for b in range(order + 1 - a)]
    bubbles = []
    for n in range(along + 1):
        t = 2 * s - 1
        bubbles.append((s * (1 - s) * t ** n, -t ** (n + 1) + (2 * n * s * (1 - s) * t ** (n - 1) if n else 0)))
    one = np.ones_like(s)
    out = [[zero, zero, term(0, 0, one, 0 * s)], [zero, zero, term(0, 0, s, one)],
           [term(1, 0, s, one), term(0, 1, s, one), zero]]
    for (a, b), (f, df) in itertools.product(powers, bubbles):
        if a >= b:
            out.append([zero, zero, term(2 * a, 2 * b, f, df) + term(2 * b, 2 * a, f, df)])
        out.append([term(2 * a + 1, 2 * b, f, df), term(2 * b, 2 * a + 1, f, df), zero])
    return np.array(out)


def estimate(x, u, order, along):
    """Offset of the second scan, travel of the plate, how far gel slid under its edge: the smooth even field through the beads
    that keeps volume, whatever the material."""
    x, u = x.reshape(-1, 3), u.reshape(-1, 3)
    grid = [(np.arange(n) + 0.5) / n for n in (5, 5, 12)]
    inside = np.array(list(itertools.product(*grid))).T
    at_beads = columns(x[:, 0] / HALF, x[:, 1] / HALF, (HALF - x[:, 2]) / (2 * HALF), order, along)
    scale = np.array([1 / HALF, 1 / HALF, -0.5 / HALF])
    slopes = columns(*inside, order, along)[:, :, 1:] * scale[:, None]
    beads = np.concatenate([at_beads[:, c, 0] for c in range(3)], 1).T
    p = np.zeros(len(at_beads))
    for _ in range(8):  # Gauss-Newton
        f = np.moveaxis(np.einsum("n,ncdp->cdp", p, slopes), 2, 0) + np.eye(3)
        j = np.linalg.det(f)
        dj = np.einsum("p,pdc,ncdp->pn", j, np.linalg.inv(f), slopes)
        rows = np.concatenate([beads / BEAD, dj / VOLUME])
        p += np.linalg.lstsq(rows, np.concatenate([(u.T.ravel() - beads @ p) / BEAD, (1 - j) / VOLUME]), rcond=1e-10)[0]
    off = u.T.ravel() - beads @ p
    return p[0], p[1], p[2], np.sqrt(3 * (off ** 2).mean()), np.sqrt(((j - 1) ** 2).mean())


def main(before, after, table):
    start, end = read(before), read(after)
    x = start - start.mean((0, 1, 2))  # the beads' grid is in the middle of the cube
    u = end - start
    places, ways = mirrored(x).mean(0), mirrored(u).mean(0)

    for name, field in (("as scanned", u), ("layers levelled", levelled(u, x))):
        images = mirrored(field)
        print(f"scatter of mirrored beads, rms: {np.sqrt(((images - images.mean(0)) ** 2).sum(-1).mean()):.2f} mm, {name}")
    for order, along in ((1, 3), (2, 3), (2, 4), (3, 4), (3, 5)):
        foot, travel, slip, off, volume = estimate(places, ways, order, along)
        print(f"orders {order}, {along}: foot {foot:.2f}, travel {travel:.2f}, slip at the edge {slip:.1f} mm; "
              f"beads {off:.2f} mm, volume {100 * volume:.1f} %")

    with open(table, "w", encoding="utf-8") as out:  # z upwards from the base, m
        out.write("body,x [m],y [m],z [m],ux [m],uy [m],uz [m]\n")
        for i, j, k in itertools.product(range(3, 7), range(3, 7), range(7)):
            if j <= i:
                (px, py, pz), (ux, uy, uz) = places[i, j, k], ways[i, j, k]
                row = (px, py, HALF - pz, ux, uy, FOOT - uz)  # 1e-9: halves go up whatever the order of sums
                out.write("cube," + ",".join(f"{round(100 * v + 1e-9) / 1e5 + 0.0:g}" for v in row) + "\n")


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    main(*sys.argv[1:])
