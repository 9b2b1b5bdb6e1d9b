#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Two equal balls pressed together without friction: the force, against Hertz's.

Hertz's formula is that of half-spaces at vanishing depth. Here is the same for neo-Hookean balls whose halves away from each
other are held (beyond the plane through the middle) and go towards each other, each by d from where they touch: by symmetry
a half ball that is bonded on its flat face and goes by d against a rigid plane. Axisymmetric finite elements with 9 nodes,
finer towards the contact, large strain; nodes that would pass the plane are held on it, those that it would have to pull
are free.

    python3 pressed_balls.py    # writes pressed_balls.json beside it

Needs numpy and scipy (Debian packages python3-numpy, python3-scipy); some ten minutes, the finest mesh most of them.
"""
import json
import math
import pathlib

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import splu

E, NU = 1e4, 0.3
LAMBDA, MU = E * NU / ((1 + NU) * (1 - 2 * NU)), E / (2 * (1 + NU))
DEPTHS = (0.0005, 0.002, 0.005, 0.01, 0.02)  # d / R, of each ball
GROWTH = 1.3  # of the depth from one solution to the next
LEVELS = (1, 2, 3, 4)


def geometric(count, ratio):
    """Breaks of 0 ... 1, the last interval `ratio` times the first."""
    steps = ratio ** (np.arange(count) / (count - 1))
    return np.concatenate([[0.0], np.cumsum(steps) / steps.sum()])


def with_middles(breaks):
    out = np.empty(2 * len(breaks) - 1)
    out[::2], out[1::2] = breaks, 0.5 * (breaks[1:] + breaks[:-1])
    return out


class HalfBall:
    """Radius 1, z <= 0, held at z = 0, the pole at z = -1. Nodes over (angle from the pole, depth below the surface)."""

    def __init__(self, level):
        angles = with_middles(0.5 * math.pi * geometric(18 * level, 30.0))
        depths = with_middles(geometric(15 * level, 40.0))
        angle, depth = np.meshgrid(angles, depths, indexing='ij')
        self.X = np.stack([(1 - depth) * np.sin(angle), -(1 - depth) * np.cos(angle)], axis=-1).reshape(-1, 2)
        self.X[np.abs(self.X) < 1e-14] = 0.0
        across, down = len(angles), len(depths)
        number = np.arange(across * down).reshape(across, down)
        a, b = np.meshgrid(np.arange(0, across - 1, 2), np.arange(0, down - 1, 2), indexing='ij')
        self.elements = np.stack([number[a.ravel() + i, b.ravel() + j] for j in range(3) for i in range(3)], axis=-1)
        self.surface = number[:, 0]  # from the pole on
        held = np.zeros((across * down, 2), bool)
        held[number[-1]] = held[number[:, -1]] = True  # the flat face, and the middle
        held[number[0], 0] = True                      # the axis
        self.held = held.ravel()
        self.points()

    def points(self):
        """Weights and derivatives of F with respect to the freedoms, at 3 x 3 points of each element."""
        def line(s):
            return np.array([0.5 * s * (s - 1), 1 - s * s, 0.5 * s * (s + 1)]), np.array([s - 0.5, -2 * s, s + 0.5])

        x, w = np.polynomial.legendre.leggauss(3)
        corners = self.X[self.elements]
        self.B, self.weights = [], []
        for s, ws in zip(x, w):
            for t, wt in zip(x, w):
                (f, df), (g, dg) = line(s), line(t)
                shape = np.outer(g, f).ravel()
                local = np.stack([np.outer(g, df).ravel(), np.outer(dg, f).ravel()])
                jacobian = np.einsum('ka,eai->eki', local, corners)
                gradient = np.linalg.solve(jacobian, np.broadcast_to(local, (len(corners), 2, 9)))
                radius = corners[:, :, 0] @ shape
                self.weights.append(2 * math.pi * radius * ws * wt * np.abs(np.linalg.det(jacobian)))
                B = np.zeros((len(corners), 5, 9, 2))  # F_rr, F_rz, F_zr, F_zz, F_tt
                B[:, 0, :, 0], B[:, 1, :, 0] = gradient[:, 0], gradient[:, 1]
                B[:, 2, :, 1], B[:, 3, :, 1] = gradient[:, 0], gradient[:, 1]
                B[:, 4, :, 0] = shape / radius[:, None]
                self.B.append(B.reshape(len(corners), 5, 18))

    def forces(self, u):
        """Internal forces and tangent, or None where a point is inverted."""
        freedoms = (2 * self.elements[:, :, None] + np.arange(2)).reshape(len(self.elements), 18)
        f, K = np.zeros((len(freedoms), 18)), np.zeros((len(freedoms), 18, 18))
        for B, w in zip(self.B, self.weights):
            F = np.einsum('ecd,ed->ec', B, u[freedoms]) + np.array([1.0, 0, 0, 1.0, 1.0])
            plane = F[:, 0] * F[:, 3] - F[:, 1] * F[:, 2]
            J = plane * F[:, 4]
            if (J <= 0).any():
                return None
            G = np.stack([F[:, 3], -F[:, 2], -F[:, 1], F[:, 0], plane / F[:, 4]], axis=1) / plane[:, None]  # F^-T
            log = np.log(J)[:, None]
            P = MU * (F - G) + LAMBDA * log * G
            # dP = mu dF + (mu - lambda log J) G dF^T G + lambda (G : dF) G
            C = LAMBDA * np.einsum('ea,eb->eab', G, G)
            C[:, range(5), range(5)] += MU
            c = MU - LAMBDA * log[:, 0]
            for i in range(2):
                for j in range(2):
                    for k in range(2):
                        for l in range(2):
                            C[:, 2 * i + j, 2 * k + l] += c * G[:, 2 * i + l] * G[:, 2 * k + j]
            C[:, 4, 4] += c * G[:, 4] ** 2
            f += np.einsum('e,ecd,ec->ed', w, B, P)
            K += np.einsum('e,ecd,ecb,ebf->edf', w, B, C, B, optimize=True)
        size = 2 * len(self.X)
        rows = np.repeat(freedoms, 18, axis=1).ravel()
        columns = np.tile(freedoms, (1, 18)).ravel()
        tangent = coo_matrix((K.ravel(), (rows, columns)), (size, size)).tocsc()
        return np.bincount(freedoms.ravel(), f.ravel(), size), tangent

    def press(self, depth, u, touching):
        """Against the plane z = depth - 1, from a solution nearby. @return u, touching, force, contact radius"""
        plane = depth - 1.0
        z = 2 * self.surface + 1
        released = -1
        for _ in range(200):
            held = self.held.copy()
            held[z[:touching]] = True
            free = np.flatnonzero(~held)
            change = np.zeros_like(u)
            change[z[:touching]] = plane - self.X[self.surface[:touching], 1] - u[z[:touching]]
            f, K = self.forces(u)
            for _ in range(30):
                rest = f + K @ change
                change[free] = splu(K[free][:, free]).solve(-rest[free])
                while self.forces(u + change) is None:
                    change *= 0.5
                u, change = u + change, np.zeros_like(u)
                change[z[:touching]] = plane - self.X[self.surface[:touching], 1] - u[z[:touching]]
                f, K = self.forces(u)
                if np.abs(f[free]).max() < 1e-10 * np.abs(f).max() and np.abs(change).max() < 1e-14:
                    break
            below = np.flatnonzero(self.X[self.surface, 1] + u[z] < plane - 1e-12)
            beyond = below[below >= touching]
            if len(beyond):
                touching += (len(beyond) + 1) // 2
            elif touching > 1 and f[z[touching - 1]] < 0.0:
                if released == touching:  # again: the edge of the contact is between two nodes
                    break
                released = touching
                touching -= 1
            else:
                break
        edge = self.surface[touching - 1]
        return u, touching, f[z[:-1]].sum(), self.X[edge, 0] + u[2 * edge]  # the last one is on the flat face


def main():
    found = {}
    for level in LEVELS:
        mesh = HalfBall(level)
        u, touching = np.zeros(2 * len(mesh.X)), 1
        reached = DEPTHS[0]
        for depth in DEPTHS:
            while reached < depth / GROWTH:
                reached *= GROWTH
                u, touching, _, _ = mesh.press(reached, u, touching)
            reached = depth
            u, touching, force, radius = mesh.press(depth, u, touching)
            hertz = 4 / 3 * E / (1 - NU ** 2) * depth ** 1.5
            found.setdefault(depth, []).append(force / E)
            print(f'level {level}, {2 * len(mesh.X)} freedoms: d/R {depth:g}, F/(E R^2) {force / E:.6e}, '
                  f'of Hertz {force / hertz:.4f}, contact radius {radius:.4f}, {touching} nodes touch', flush=True)
    out = [{'depth_over_R': depth, 'force_over_ER2': values[-1], 'of_hertz':
            values[-1] / (4 / 3 / (1 - NU ** 2) * depth ** 1.5), 'levels': values} for depth, values in found.items()]
    path = pathlib.Path(__file__).with_suffix('.json')
    path.write_text(json.dumps({'law': 'neo_hookean', 'poisson_ratio': NU, 'forces': out}, indent=1) + '\n')


if __name__ == '__main__':
    main()
