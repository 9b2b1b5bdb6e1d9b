#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A square beam in a lattice that is rotated against it: error of its stiffness in bending, torsion and tension.

Small strain, no supports: both ends carry opposite tractions of pure bending, torsion or tension, and the rates between two
sections are compared with beam theory. Two formulations are compared:

  cells      the eight corners of a cell: mean gradient of the cut part and the energy of modes of docs/theory/lattice.md
  quadratic  functions of second order along the edges of cut cells (sampling.order = "quadratic"):

                 u(x) = sum_k N_k(x) u_k + sum_e E_e(x) b_e,     b = (-u_0 + u_1 + u_2 - u_3)/16 over four corners in a row

             and (-u_0 + 2 u_1 - u_2)/8 at the end of a row. All cells around an edge have the same b: the functions are
             continuous, and affine motions and rigid rotations are exact. The energy of a part is that of its mean strain
             and of the linear variation of its strain, from the means of the second derivatives and the covariance of
             the part. The Lame constant of the variation is 2 lambda mu/(lambda + 2 mu). There is no factor that was
             fitted to beams. Cells without such an edge are those of the first formulation.

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
# Edges of a cell: axis, and the corner at its lower end.
EDGES = [(a, k) for k, c in enumerate(CORNERS) for a in range(3) if c[a] < 0]
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
        self.keys = list(self.nodes)
        curved = {self.edge(c, e) for c in self.cells if c["is_cut"] for e in EDGES} if is_quadratic else set()
        for cell in self.cells:
            self.extend(cell, curved)

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
                           "nodes": list(corners), "is_cut": share.mean() < 0.999})

    def neighbour(self, key, axis, side):
        return tuple(key[a] + (2 * side if a == axis else 0) for a in range(3))

    def edge(self, cell, edge):
        axis, corner = edge
        low = cell["nodes"][corner]
        return low, self.nodes[self.neighbour(self.keys[low], axis, 1)], axis

    def coefficient(self, low, high, axis):
        """{node: weight} of the function of an edge."""
        before = self.nodes.get(self.neighbour(self.keys[low], axis, -1))
        after = self.nodes.get(self.neighbour(self.keys[high], axis, 1))
        if before is not None and after is not None:
            return {before: -1 / 16, low: 1 / 16, high: 1 / 16, after: -1 / 16}
        if after is not None:
            return {low: -1 / 8, high: 2 / 8, after: -1 / 8}
        return {before: -1 / 8, low: 2 / 8, high: -1 / 8} if before is not None else {}

    def extend(self, cell, curved):
        edges = [self.edge(cell, e) for e in EDGES]
        coefficients = [self.coefficient(*e) if e in curved else {} for e in edges]
        nodes = list(dict.fromkeys(cell["nodes"] + [j for c in coefficients for j in c]))
        rows = np.zeros((12, len(nodes)))
        for r, coefficient in enumerate(coefficients):
            for j, weight in coefficient.items():
                rows[r, nodes.index(j)] = weight
        cell["nodes"], cell["rows"] = np.array(nodes), rows

    def functions(self, cell, at):
        """Values (n, nodes) and gradients (n, nodes, 3) at points relative to the middle."""
        n, g = trilinear(2 * at)
        on_edges, slopes = np.zeros((len(at), 12)), np.zeros((len(at), 12, 3))
        for e, (a, k) in enumerate(EDGES):
            b, c = (a + 1) % 3, (a + 2) % 3
            f, nb, nc = 1 - 4 * at[:, a] ** 2, 0.5 + CORNERS[k, b] * at[:, b], 0.5 + CORNERS[k, c] * at[:, c]
            on_edges[:, e], slopes[:, e, a] = f * nb * nc, -8 * at[:, a] * nb * nc
            slopes[:, e, b], slopes[:, e, c] = f * CORNERS[k, b] * nc, f * nb * CORNERS[k, c]
        values, gradients = on_edges @ cell["rows"], np.einsum("neb,ej->njb", slopes, cell["rows"])
        values[:, :8] += n
        gradients[:, :8] += g
        return values, gradients

    def second_derivatives(self, cell):
        """Means over the part: (3, 3, nodes)."""
        x, w = self.samples, cell["weights"]
        on_edges, on_corners = np.zeros((3, 3, 12)), np.zeros((3, 3, 8))
        for e, (a, k) in enumerate(EDGES):
            b, c = (a + 1) % 3, (a + 2) % 3
            sb, sc, nb, nc = CORNERS[k, b], CORNERS[k, c], 0.5 + CORNERS[k, b] * x[:, b], 0.5 + CORNERS[k, c] * x[:, c]
            on_edges[a, a, e] = w @ (-8 * nb * nc)
            on_edges[a, b, e] = on_edges[b, a, e] = w @ (-8 * x[:, a] * sb * nc)
            on_edges[a, c, e] = on_edges[c, a, e] = w @ (-8 * x[:, a] * sc * nb)
            on_edges[b, c, e] = on_edges[c, b, e] = w @ (1 - 4 * x[:, a] ** 2) * sb * sc
        for m, (a, b) in enumerate([(0, 1), (0, 2), (1, 2)]):
            on_corners[a, b] = on_corners[b, a] = MODES[m] / 2 + MODES[3] * (w @ x[:, 3 - a - b])
        out = on_edges @ cell["rows"]
        out[:, :, :8] += on_corners
        return out

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
    if not cell["rows"].any():
        return cell_stiffness(lattice, cell, lam, mu)
    w, v = cell["weights"], cell["volume"]
    away = lattice.samples - w @ lattice.samples
    spread = (away * w[:, None]).T @ away
    mean = strain_rows(np.tensordot(w, lattice.functions(cell, lattice.samples)[1], axes=(0, 0)))
    k = v * mean.T @ stiffness(lam, mu) @ mean
    slopes = [strain_rows(h.T) for h in lattice.second_derivatives(cell)]
    c = stiffness(2 * lam * mu / (lam + 2 * mu), mu)
    for a, b in itertools.product(range(3), repeat=2):
        k += v * spread[a, b] * slopes[a].T @ c @ slopes[b]
    for i in range(3):
        row = np.zeros(len(k))
        row[i:24:3] = MODES[3]
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
