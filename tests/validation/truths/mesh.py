# SPDX-License-Identifier: Apache-2.0
"""Structured meshes of hexahedra: blocks of a lattice, mapped and merged.

An element has 27 nodes in lattice order, node (i, j, k) being number i + 3 j + 9 k. Quadratic elements with 20 nodes
take the corners and the middles of edges of the same lattice, so both kinds describe one body.
"""
import math
from collections import namedtuple

CORNERS_AND_EDGES = [  # Abaqus / CalculiX order of C3D20 as (i, j, k)
    (0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2),
    (1, 0, 0), (2, 1, 0), (1, 2, 0), (0, 1, 0), (1, 0, 2), (2, 1, 2), (1, 2, 2), (0, 1, 2),
    (0, 0, 1), (2, 0, 1), (2, 2, 1), (0, 2, 1)]
SERENDIPITY = [i + 3 * j + 9 * k for i, j, k in CORNERS_AND_EDGES]

# Faces as 9 lattice nodes (number p + 3 q), the normal t_p x t_q pointing outwards, with CalculiX's face number.
Face = namedtuple('Face', 'element lattice number')


def _faces():
    def nodes(at):
        return [sum(c * s for c, s in zip(at(p, q), (1, 3, 9))) for q in range(3) for p in range(3)]
    return [
        (nodes(lambda p, q: (q, p, 0)), 1), (nodes(lambda p, q: (p, q, 2)), 2),
        (nodes(lambda p, q: (p, 0, q)), 3), (nodes(lambda p, q: (2, p, q)), 4),
        (nodes(lambda p, q: (q, 2, p)), 5), (nodes(lambda p, q: (0, q, p)), 6)]


FACES = _faces()
_GAUSS = [(-math.sqrt(0.6), 5 / 9), (0.0, 8 / 9), (math.sqrt(0.6), 5 / 9)]


def _quadratic(t):
    return (0.5 * t * (t - 1), 1 - t * t, 0.5 * t * (t + 1)), (t - 0.5, -2 * t, t + 0.5)


def _cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def _shape(local, order):
    """Values and slopes (3) of the shape functions by lattice number; order 27 or 20 (others are zero then)."""
    (u, du), (v, dv), (w, dw) = (_quadratic(t) for t in local)
    if order == 27:
        return {i + 3 * j + 9 * k: (u[i] * v[j] * w[k], (du[i] * v[j] * w[k], u[i] * dv[j] * w[k], u[i] * v[j] * dw[k]))
                for k in range(3) for j in range(3) for i in range(3)}
    out = {}
    for ijk in CORNERS_AND_EDGES:
        s = [c - 1 for c in ijk]
        factors = [(1 + sc * t, sc) if sc else (1 - t * t, -2 * t) for sc, t in zip(s, local)]
        f = [a for a, _ in factors]
        if 0 in s:
            scale, value, slopes = 0.25, 1.0, (0.0, 0.0, 0.0)
        else:
            scale = 0.125
            value = sum(sc * t for sc, t in zip(s, local)) - 2
            slopes = s
        product = f[0] * f[1] * f[2]
        others = (f[1] * f[2], f[0] * f[2], f[0] * f[1])
        out[ijk[0] + 3 * ijk[1] + 9 * ijk[2]] = (
            scale * product * value,
            tuple(scale * (factors[c][1] * others[c] * value + product * slopes[c]) for c in range(3)))
    return out


def _surface_shape(p, q, order):
    """The same on a face, lattice number p + 3 q."""
    (u, du), (v, dv) = _quadratic(p), _quadratic(q)
    if order == 27:
        return {i + 3 * j: (u[i] * v[j], du[i] * v[j], u[i] * dv[j]) for j in range(3) for i in range(3)}
    full = _shape((p, q, -1.0), 20)
    return {n: (value, slope[0], slope[1]) for n, (value, slope) in full.items() if n < 9}


class Mesh:
    """Nodes [(x, y, z)], elements [27 node numbers] and, per element, the number of its material."""

    def __init__(self, merge=1e-7):
        self.nodes, self.elements, self.materials = [], [], []
        self._merge, self._index = merge, {}

    def node(self, at):
        key = [math.floor(c / self._merge + 0.5) for c in at]
        found = self._index.get(tuple(key))
        if found is None:  # a neighbour cell of the grid may hold it
            for d in ((i, j, k) for i in (-1, 0, 1) for j in (-1, 0, 1) for k in (-1, 0, 1)):
                found = self._index.get((key[0] + d[0], key[1] + d[1], key[2] + d[2]))
                if found is not None:
                    return found
            found = len(self.nodes)
            self.nodes.append(tuple(at))
            self._index[tuple(key)] = found
        return found

    def block(self, us, vs, ws, mapping, material=lambda centre: 0):
        """Adds elements between the break points of the three parameters, mapped to space by mapping(u, v, w)."""
        def lattice(breaks):
            return [x for a, b in zip(breaks, breaks[1:]) for x in (a, 0.5 * (a + b))] + [breaks[-1]]
        lu, lv, lw = lattice(us), lattice(vs), lattice(ws)
        numbers = [[[self.node(mapping(u, v, w)) for u in lu] for v in lv] for w in lw]
        for k in range(0, len(lw) - 1, 2):
            for j in range(0, len(lv) - 1, 2):
                for i in range(0, len(lu) - 1, 2):
                    element = [numbers[k + c][j + b][i + a] for c in range(3) for b in range(3) for a in range(3)]
                    if self._volume_sign(element) < 0:
                        element = [element[2 - a + 3 * b + 9 * c] for c in range(3) for b in range(3) for a in range(3)]
                    self.elements.append(element)
                    self.materials.append(material(self.nodes[element[13]]))
        return self

    def _volume_sign(self, element):
        at = [self.nodes[n] for n in element]
        du, dv, dw = (tuple(b - a for a, b in zip(at[p], at[q])) for p, q in ((12, 14), (10, 16), (4, 22)))
        return sum(a * b for a, b in zip(_cross(du, dv), dw))

    def used(self, order):
        """Node numbers that an order of elements uses, ascending."""
        lattice = range(27) if order == 27 else SERENDIPITY
        return sorted({element[n] for element in self.elements for n in lattice})

    def select(self, predicate, order=27):
        return [n for n in self.used(order) if predicate(*self.nodes[n])]

    def faces(self, predicate):
        """Faces all of whose nodes satisfy predicate(x, y, z)."""
        inside = [predicate(*at) for at in self.nodes]
        return [Face(e, lattice, number) for e, element in enumerate(self.elements) for lattice, number in FACES
                if all(inside[element[n]] for n in lattice)]

    def surface_weights(self, faces, order):
        """{node: integral of its shape function over the faces}, m^2."""
        out = {}
        for face in faces:
            ids = [self.elements[face.element][n] for n in face.lattice]
            for p, wp in _GAUSS:
                for q, wq in _GAUSS:
                    shape = _surface_shape(p, q, order)
                    t1, t2 = ([sum(shape[n][c] * self.nodes[ids[n]][axis] for n in shape) for axis in range(3)]
                              for c in (1, 2))
                    area = math.hypot(*_cross(t1, t2)) * wp * wq
                    for n, values in shape.items():
                        out[ids[n]] = out.get(ids[n], 0.0) + values[0] * area
        return out

    def volume_weights(self, order):
        """{node: integral of its shape function over the body}, m^3."""
        points = [(_shape((p, q, r), order), wp * wq * wr)
                  for p, wp in _GAUSS for q, wq in _GAUSS for r, wr in _GAUSS]
        out = {}
        for element in self.elements:
            for shape, weight in points:
                rows = [[sum(slope[c] * self.nodes[element[n]][axis] for n, (_, slope) in shape.items())
                         for axis in range(3)] for c in range(3)]
                volume = sum(a * b for a, b in zip(_cross(rows[0], rows[1]), rows[2])) * weight
                for n, (value, _) in shape.items():
                    out[element[n]] = out.get(element[n], 0.0) + value * volume
        return out


def uniform(a, b, n):
    return [a + (b - a) * i / n for i in range(n + 1)]


def graded(a, b, n, start=1.0, end=1.0):
    """n intervals from a to b by a smooth map whose slope at the ends is about `start` and `end` times the middle's.

    The map is the same at every n, so refining keeps the proportions and extrapolation stays valid.
    """
    steps = 2000
    def density(t):  # slope of the map
        low = start + (1 - start) * min(1.0, 2 * t) if start < 1 else 1.0
        high = end + (1 - end) * min(1.0, 2 * (1 - t)) if end < 1 else 1.0
        return low * high
    cumulative = [0.0]
    for i in range(steps):
        cumulative.append(cumulative[-1] + density((i + 0.5) / steps))
    return [a + (b - a) * cumulative[round(i * steps / n)] / cumulative[-1] for i in range(n + 1)]


def box(low, high, breaks, material=lambda centre: 0):
    """Axis-parallel box; `breaks` are the three lists of break points."""
    mesh = Mesh(merge=1e-6 * max(h - l for l, h in zip(low, high)))
    return mesh.block(*breaks, lambda u, v, w: (u, v, w), material)
