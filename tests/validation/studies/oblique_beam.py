#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A square beam in a lattice that is rotated against it: error of its stiffness in bending, torsion and tension.

Small strain, no supports: both ends carry opposite tractions of pure bending, torsion or tension, and the rates between two
sections are compared with beam theory. Two formulations are compared:

  cells      the eight corners of a cell: mean gradient of the cut part and the energy of modes of docs/theory/lattice.md
  quadratic  functions that also reproduce quadratic motions:

                 u(x) = sum_k N_k(x) (u_k + 1/2 G_k (x - x_k)),     G_k: gradient at corner k from its neighbours

             Differences are central; at the last corner of a row G follows from the corner before it, so that it is exact for
             quadratic motions. The functions are continuous, and affine motions and rigid rotations are exact. The energy of
             a part is that of its mean strain and of the linear variation of its strain, by the covariance of the part. The
             Lame constant of the variation is 2 lambda mu/(lambda + 2 mu). There is no factor that was fitted to beams.

    python3 oblique_beam.py [CELLS] [POISSON_RATIO]      default: 3 0.3; a minute

Needs numpy (Debian package python3-numpy).
"""
import itertools
import math
import sys

import numpy as np

SAMPLES = 8  # per axis and cell
CORNERS = np.array(list(itertools.product([-1, 1], repeat=3)), float)
MODES = np.stack([CORNERS[:, 0] * CORNERS[:, 1], CORNERS[:, 0] * CORNERS[:, 2], CORNERS[:, 1] * CORNERS[:, 2],
                  CORNERS.prod(1)])
E = 1.0


def rotation(axis, degrees):
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return np.array({"x": [[1, 0, 0], [0, c, -s], [0, s, c]], "y": [[c, 0, s], [0, 1, 0], [-s, 0, c]],
                     "z": [[c, -s, 0], [s, c, 0], [0, 0, 1]]}[axis])


def trilinear(xi):
    """Values (n, 8) and gradients (n, 8, 3) at xi in -1 ... 1; edges of length 1."""
    t = 1 + xi[:, None, :] * CORNERS
    g = np.empty(t.shape)
    for a in range(3):
        g[:, :, a] = CORNERS[:, a] * t[:, :, (a + 1) % 3] * t[:, :, (a + 2) % 3] / 4
    return t.prod(axis=2) / 8, g


def strain_rows(g):
    """Strain xx yy zz yz xz xy (shears doubled) of displacements with gradients g (n, 3)."""
    rows = np.zeros((6, 3 * len(g)))
    for a, (i, j) in enumerate([(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)]):
        rows[a, i::3] = g[:, j]
        if i != j:
            rows[a, j::3] = g[:, i]
    return rows


def stiffness(lam, mu):
    c = np.zeros((6, 6))
    c[:3, :3] = lam
    c[range(6), range(6)] += [2 * mu] * 3 + [mu] * 3
    return c


class Lattice:
    """Cells of edge 1 that contain part of the beam: x along it, `width` across, middle at the origin."""

    def __init__(self, turn, width, length, is_quadratic):
        self.turn, self.half, self.nodes, self.cells = turn, np.array([length, width, width]) / 2, {}, []
        grid = (np.arange(SAMPLES) + 0.5) / SAMPLES - 0.5
        self.samples = np.stack([x.ravel() for x in np.meshgrid(grid, grid, grid, indexing="ij")], 1)
        reach = np.ceil(np.abs(turn) @ self.half + 1).astype(int)
        for index in itertools.product(*(range(-n, n + 1) for n in reach)):
            self.add_cell(np.array(index) + 0.5)
        scale = 8 * self.half.prod() / sum(c["volume"] for c in self.cells)
        for cell in self.cells:
            cell["volume"] *= scale
        self.gradients = [self.gradient(k) if is_quadratic else {} for k in self.nodes]
        for cell in self.cells:
            self.extend(cell)

    def add_cell(self, middle):
        if np.any(np.abs(middle @ self.turn) > self.half + 0.87):
            return
        at, share = (middle + self.samples) @ self.turn, np.ones(SAMPLES**3)
        for a, side in itertools.product(range(3), (1, -1)):
            thickness = np.abs(self.turn[:, a]).sum() / SAMPLES
            share *= np.clip((self.half[a] - side * at[:, a]) / thickness + 0.5, 0, 1)
        if share.mean() < 0.02:
            return
        normal, (u, v) = np.zeros(3), (x.ravel() for x in np.meshgrid(*[(np.arange(16) + 0.5) / 16 - 0.5] * 2))
        for a, side in itertools.product(range(3), (1, -1)):
            face = np.zeros((256, 3))
            face[:, a], face[:, (a + 1) % 3], face[:, (a + 2) % 3] = side / 2, u, v
            normal[a] -= side * np.all(np.abs((middle + face) @ self.turn) <= self.half, axis=1).mean()
        corners = [self.nodes.setdefault(tuple(np.round(2 * middle + c).astype(int)), len(self.nodes)) for c in CORNERS]
        self.cells.append({"middle": middle, "volume": share.mean(), "weights": share / share.sum(), "normal": normal,
                           "nodes": corners})

    def neighbour(self, key, axis, side):
        return tuple(key[a] + (2 * side if a == axis else 0) for a in range(3))

    def gradient(self, key):
        """{node: vector}: the gradient at a node is the sum of vector times value."""
        rows = {}
        for a in range(3):
            for node, value in self.difference(key, a).items():
                rows.setdefault(node, np.zeros(3))[a] += value
        return rows

    def difference(self, key, a):
        ends = [self.nodes.get(self.neighbour(key, a, side)) for side in (1, -1)]
        if None not in ends:
            return {ends[0]: 0.5, ends[1]: -0.5}
        side = 1 if ends[0] is not None else -1
        inner = self.neighbour(key, a, side)
        if inner not in self.nodes:
            return {}
        row = {self.nodes[inner]: 1.0 * side, self.nodes[key]: -1.0 * side}
        beyond = self.nodes.get(self.neighbour(inner, a, side))
        if beyond is None:  # two corners only: linear
            return row
        row = {node: 2 * value for node, value in row.items()}
        for node, value in ((beyond, 0.5 * side), (self.nodes[key], -0.5 * side)):
            row[node] = row.get(node, 0.0) - value
        return row

    def extend(self, cell):
        nodes = list(cell["nodes"])
        for k in cell["nodes"]:
            nodes += [j for j in self.gradients[k] if j not in nodes]
        rows = np.zeros((8, len(nodes), 3))
        for r, k in enumerate(cell["nodes"]):
            for j, vector in self.gradients[k].items():
                rows[r, nodes.index(j)] = vector
        cell["nodes"], cell["rows"] = np.array(nodes), rows

    def functions(self, cell, at):
        """Values (n, nodes) and gradients (n, nodes, 3) at points relative to the middle."""
        n, g = trilinear(2 * at)
        linear = np.einsum("nka,kja->nkj", at[:, None, :] - CORNERS / 2, cell["rows"])
        values = 0.5 * np.einsum("nk,nkj->nj", n, linear)
        gradients = 0.5 * (np.einsum("nkb,nkj->njb", g, linear) + np.einsum("nk,kjb->njb", n, cell["rows"]))
        values[:, :8] += n
        gradients[:, :8] += g
        return values, gradients

    def rows_at(self, points):
        middles = np.array([c["middle"] for c in self.cells])
        out = np.zeros((len(points), len(self.nodes)))
        for r, p in enumerate(points):
            cell = self.cells[int(np.argmin(((middles - p) ** 2).sum(1)))]
            out[r, cell["nodes"]] += self.functions(cell, (p - cell["middle"])[None])[0][0]
        return out


def mode_rows(g):
    """Coefficients of xy, xz, yz and xyz, without affine motions."""
    return np.array([(1.0 if m == 3 else 0.5) * (s - (s @ (CORNERS / 2)) @ g.T) for m, s in enumerate(MODES)])


def cell_stiffness(lattice, cell, lam, mu):
    """Mean gradient and energy of modes: docs/theory/lattice.md."""
    w, v = cell["weights"], cell["volume"]
    g = np.tensordot(w, trilinear(2 * lattice.samples)[1], axes=(0, 0))
    rows = strain_rows(g)
    k = v * rows.T @ stiffness(lam, mu) @ rows
    away = lattice.samples - w @ lattice.samples
    spread, modes = w @ away**2, mode_rows(g)
    if (size := np.linalg.norm(cell["normal"])) > 1e-9:
        n = cell["normal"] / size
        for m, (i, j) in enumerate([(0, 1), (0, 2), (1, 2)]):
            modes[m] *= math.sqrt(max(0.02, 1 - 5 * n[i] ** 2 * n[j] ** 2))

    def row(i, m):
        out = np.zeros(24)
        out[i::3] = modes[m]
        return out

    def mode(a, b):
        return a + b - 1

    kappa, theta, plane, shears = 0.92, 0.42, 2 * lam * mu / (lam + 2 * mu), []
    for z in range(3):
        x, y = (z + 1) % 3, (z + 2) % 3
        xx, yy = row(x, mode(x, z)), row(y, mode(y, z))
        k += kappa * v * spread[z] * (2 * mu * (np.outer(xx, xx) + np.outer(yy, yy)) + plane * np.outer(xx + yy, xx + yy))
        shears.append(math.sqrt(spread[z]) * (row(y, mode(x, z)) + row(x, mode(y, z))))
    total = sum(shears)
    k += kappa * v * mu * (theta * sum(np.outer(t, t) for t in shears) + (1 - theta) / 3 * np.outer(total, total))
    for i in range(3):
        k += kappa * v / 144 * 0.3 * E * np.outer(row(i, 3), row(i, 3))
    return k


def quadratic_stiffness(lattice, cell, lam, mu):
    w, v = cell["weights"], cell["volume"]
    away = lattice.samples - w @ lattice.samples
    spread = (away * w[:, None]).T @ away
    gradients = lattice.functions(cell, lattice.samples)[1]
    mean = strain_rows(np.tensordot(w, gradients, axes=(0, 0)))
    k = v * mean.T @ stiffness(lam, mu) @ mean
    slopes = np.einsum("kl,nl,n,nja->kja", np.linalg.inv(spread + 1e-12 * np.eye(3)), away, w, gradients)
    slopes, c = [strain_rows(s) for s in slopes], stiffness(2 * lam * mu / (lam + 2 * mu), mu)
    for a, b in itertools.product(range(3), repeat=2):
        k += v * spread[a, b] * slopes[a].T @ c @ slopes[b]
    modes = mode_rows(np.tensordot(w, trilinear(2 * lattice.samples)[1], axes=(0, 0)))
    for i in range(3):
        row = np.zeros(len(k))
        row[i:24:3] = modes[3]
        k += v / 144 * 0.3 * E * np.outer(row, row)
    return k


def errors(turn, width, nu, is_quadratic):
    """Per cent by which the beam is too compliant: bending about y and z, torsion, tension."""
    length, lam, mu = 5.0 * width, E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu))
    lattice = Lattice(turn, width, length, is_quadratic)
    count = 3 * len(lattice.nodes)
    k = 1e-9 * np.eye(count)
    for cell in lattice.cells:
        one = (quadratic_stiffness if is_quadratic else cell_stiffness)(lattice, cell, lam, mu)
        dofs = (3 * cell["nodes"][:, None] + np.arange(3)).ravel()
        k[np.ix_(dofs, dofs)] += one
    points = (np.arange(24) + 0.5) / 24 * width - width / 2
    y, z = (a.ravel() for a in np.meshgrid(points, points, indexing="ij"))
    area = width**2 / 576

    def section(x):
        return lattice.rows_at(np.stack([np.full(576, x), y, z], 1) @ turn.T)

    zero, bending, torsion = 0 * y, width**4 / 12, 0.140577 * width**4
    torque = (y * y + z * z).sum() * area
    loads = [(np.stack([z / bending, zero, zero], 1), 1 / (E * bending)), (np.stack([y / bending, zero, zero], 1), 1 / (E * bending)),
             (np.stack([zero, -z, y], 1) / torque, 1 / (mu * torsion)),
             (np.stack([1 / width**2 + zero, zero, zero], 1), 1 / (E * width**2))]
    ends = section(0.49999 * length).T - section(-0.49999 * length).T
    moved = np.linalg.solve(k, np.stack([(ends @ (t @ turn.T) * area).ravel() for t, _ in loads], 1))
    middle, out = [section(-length / 6), section(length / 6)], []
    for load, (_, exact) in enumerate(loads):
        rates = []
        for rows in middle:
            u = (rows @ moved[:, load].reshape(-1, 3)) @ turn
            rates.append([(u[:, 0] * z).sum() / (z * z).sum(), (u[:, 0] * y).sum() / (y * y).sum(),
                          (u[:, 2] * y - u[:, 1] * z).sum() / (y * y + z * z).sum(), u[:, 0].mean()][load])
        out.append(100 * ((rates[1] - rates[0]) / (length / 3) / exact - 1))
    return out


def main():
    width = int(sys.argv[1]) if len(sys.argv) > 1 else 3
    nu = float(sys.argv[2]) if len(sys.argv) > 2 else 0.3
    print(f"{width} cells across, Poisson's ratio {nu}: compliance, error in per cent")
    print(f"{'rotation':>12}  {'cells: about y, about z, torsion, tension':>44}  {'quadratic':>36}")
    for axis, degrees in (("x", 0), ("x", 30), ("x", 45), ("y", 15), ("y", 30), ("y", 45)):
        columns = [" ".join(f"{e:8.2f}" for e in errors(rotation(axis, degrees), width, nu, q)) for q in (False, True)]
        print(f"{degrees:>9}° {axis}  {columns[0]:>44}  {columns[1]:>36}", flush=True)


if __name__ == "__main__":
    main()
