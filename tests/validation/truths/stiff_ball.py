#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A stiff ball in a soft cylinder that hangs by its lower face and is pressed from above: displacements.

Small strain, one Poisson ratio, the ball's modulus 100 times the cylinder's. Radius of the ball 1, of the cylinder 2, height 4, the
ball in its middle; the lower face is bonded, the upper one carries a uniform pressure p. Axisymmetric finite elements with 9
nodes along rays from the middle of the ball; borders of tissues are borders of elements.

    python3 stiff_ball.py    # writes stiff_ball.json beside it

Needs numpy and scipy (Debian packages python3-numpy, python3-scipy); half a minute.
"""
import json
import math
import pathlib

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import splu

NU, RATIO, RADIUS, HALF = 0.3, 100.0, 2.0, 2.0
LEVELS = (2, 4, 6, 8)


def with_middles(breaks):
    out = np.empty(2 * len(breaks) - 1)
    out[::2], out[1::2] = breaks, 0.5 * (breaks[1:] + breaks[:-1])
    return out


def to_wall(angle):
    """Distance from the middle to the wall of the cylinder; angles from the lower pole."""
    r, z = math.sin(angle), -math.cos(angle)
    return min(RADIUS / r if r > 1e-12 else math.inf, HALF / abs(z) if abs(z) > 1e-12 else math.inf)


def line(s):
    return np.array([0.5 * s * (s - 1), 1 - s * s, 0.5 * s * (s + 1)]), np.array([s - 0.5, -2 * s, s + 0.5])


def solve(level):
    corner = math.atan2(RADIUS, HALF)
    parts = [(0.0, corner), (corner, math.pi - corner), (math.pi - corner, math.pi)]
    angles = [0.0]
    for begin, end in parts:  # the corners of the cylinder are corners of elements
        angles += list(np.linspace(begin, end, (6 if end - begin < 1 else 10) * level + 1)[1:])
    angles = with_middles(np.array(angles))
    inner, outer = 5 * level, 8 * level
    radii = with_middles(np.concatenate([np.linspace(0, 1, inner + 1), 1 + np.linspace(0, 1, outer + 1)[1:] ** 1.3]))
    across, out = len(angles), len(radii)
    X = np.zeros((across, out, 2))
    for i, angle in enumerate(angles):
        wall = to_wall(angle)
        distance = np.where(radii <= 1, radii, 1 + (radii - 1) * (wall - 1))
        X[i, :, 0], X[i, :, 1] = distance * math.sin(angle), -distance * math.cos(angle)
    # The middle is one node in all rays.
    number = np.arange(across * out).reshape(across, out)
    number[:, 0] = number[0, 0]
    X = X.reshape(-1, 2)
    X[np.abs(X) < 1e-14] = 0.0
    a, b = np.meshgrid(np.arange(0, across - 1, 2), np.arange(0, out - 1, 2), indexing='ij')
    elements = np.stack([number[a.ravel() + j, b.ravel() + i] for j in range(3) for i in range(3)], axis=-1)
    modulus = np.where(b.ravel() < 2 * inner, RATIO, 1.0)
    lam, mu = modulus * NU / ((1 + NU) * (1 - 2 * NU)), modulus / (2 * (1 + NU))
    C = np.zeros((len(elements), 4, 4))  # rr, zz, tt, 2 rz
    C[:, :3, :3] = lam[:, None, None]
    for i in range(3):
        C[:, i, i] += 2 * mu
    C[:, 3, 3] = mu
    freedoms = (2 * elements[:, :, None] + np.arange(2)).reshape(len(elements), 18)
    K = np.zeros((len(elements), 18, 18))
    x, w = np.polynomial.legendre.leggauss(4)
    corners = X[elements]
    for s, ws in zip(x, w):
        for t, wt in zip(x, w):
            (f, df), (g, dg) = line(s), line(t)
            shape = np.outer(g, f).ravel()
            local = np.stack([np.outer(g, df).ravel(), np.outer(dg, f).ravel()])
            jacobian = np.einsum('ka,eai->eki', local, corners)
            gradient = np.linalg.solve(jacobian, np.broadcast_to(local, (len(corners), 2, 9)))
            radius = corners[:, :, 0] @ shape
            weight = 2 * math.pi * radius * ws * wt * np.abs(np.linalg.det(jacobian))
            B = np.zeros((len(corners), 4, 9, 2))
            B[:, 0, :, 0], B[:, 1, :, 1] = gradient[:, 0], gradient[:, 1]
            B[:, 2, :, 0] = shape / radius[:, None]
            B[:, 3, :, 0], B[:, 3, :, 1] = gradient[:, 1], gradient[:, 0]
            B = B.reshape(len(corners), 4, 18)
            K += np.einsum('e,ecd,ecb,ebf->edf', weight, B, C, B, optimize=True)
    size = 2 * len(X)
    A = coo_matrix((K.ravel(), (np.repeat(freedoms, 18, axis=1).ravel(), np.tile(freedoms, (1, 18)).ravel())),
                   (size, size)).tocsc()
    load = np.zeros(size)
    x, w = np.polynomial.legendre.leggauss(4)
    wall = number[:, -1]
    top = np.flatnonzero(np.abs(X[wall, 1] - HALF) < 1e-9)
    for i in top[:-2:2]:
        nodes = wall[i:i + 3]
        for s, ws in zip(x, w):
            shape, slope = line(s)
            load[2 * nodes + 1] -= 2 * math.pi * (X[nodes, 0] @ shape) * abs(X[nodes, 0] @ slope) * ws * shape
    held = np.zeros(size, bool)
    held[2 * np.flatnonzero(X[:, 0] == 0.0)] = True
    bottom = np.flatnonzero(np.abs(X[:, 1] + HALF) < 1e-9)
    held[2 * bottom] = held[2 * bottom + 1] = True
    used = np.zeros(size, bool)
    used[freedoms.ravel()] = True
    free = np.flatnonzero(~held & used)
    u = np.zeros(size)
    u[free] = splu(A[free][:, free]).solve(load[free])
    side = wall[np.argmin(np.abs(X[wall, 1]) + (X[wall, 0] < 1))]
    mean = 0.0
    for i in top[:-2:2]:
        nodes = wall[i:i + 3]
        for s, ws in zip(x, w):
            shape, slope = line(s)
            mean += 2 * (X[nodes, 0] @ shape) * abs(X[nodes, 0] @ slope) * ws * (u[2 * nodes + 1] @ shape) / RADIUS ** 2
    pole = number[-1, 2 * inner]
    return len(free), {'top_mean_z': mean, 'top_axis_z': u[2 * wall[-1] + 1], 'ball_pole_z': u[2 * pole + 1],
                       'ball_middle_z': u[2 * number[0, 0] + 1], 'side_r': u[2 * side]}


def main():
    levels = []
    for level in LEVELS:
        unknowns, values = solve(level)
        levels.append({'unknowns': unknowns, **values})
        print(level, unknowns, values, flush=True)
    out = {'law': 'linear', 'poisson_ratio': NU, 'ratio_of_moduli': RATIO,
           'unit': 'displacement times E of the cylinder over pressure and radius of the ball',
           'values': {k: v for k, v in levels[-1].items() if k != 'unknowns'}, 'levels': levels}
    pathlib.Path(__file__).with_suffix('.json').write_text(json.dumps(out, indent=1) + '\n')


if __name__ == '__main__':
    main()
