# SPDX-License-Identifier: Apache-2.0
"""What both solvers are given: a mesh, materials, supports and loads; and what is measured on their results."""
import math
from collections import namedtuple

Material = namedtuple('Material', 'law youngs_modulus poisson_ratio density')


class Model:
    """`order` 20 (CalculiX) or 27 (truth_fem) chooses the shape functions of loads and mean values."""

    def __init__(self, mesh, materials, order, stages=(1.0,), increment=1.0):
        self.mesh, self.materials, self.order = mesh, materials, order
        self.law = materials[0].law
        self.element = 'C3D20R'
        self.stages, self.increment = list(stages), increment
        self.held, self.forces, self.pressures = {}, {}, []
        self.gravity, self.frequencies = (0.0, 0.0, 0.0), 0

    def hold(self, region, motion=lambda at, t: (0.0, 0.0, 0.0), axes=(0, 1, 2)):
        """Prescribes motion(X, t), t = 0..1, on the nodes of the region; the first prescription of a freedom stays."""
        count = len(self.stages)
        for n in self.mesh.select(region, self.order):
            paths = [motion(self.mesh.nodes[n], (s + 1) / count) for s in range(count)]
            for axis in axes:
                self.held.setdefault((n, axis), [p[axis] for p in paths])

    def mirror(self, *axes):
        """Symmetry planes through the origin."""
        for axis in axes:
            self.hold(lambda *at: abs(at[axis]) < 1e-9, axes=(axis,))

    def load(self, region, traction):
        """Dead traction (N/m^2 of the reference surface)."""
        for n, weight in self.mesh.surface_weights(self.mesh.faces(region), self.order).items():
            force = self.forces.setdefault(n, [0.0, 0.0, 0.0])
            for axis in range(3):
                force[axis] += weight * traction[axis]

    def press(self, region, pressure):
        """Pressure (Pa) that stays normal to the deformed surface."""
        self.pressures += [(face, pressure) for face in self.mesh.faces(region)]


class Result:
    """Displacements u and internal forces f by node, with the functionals that cases ask for."""

    def __init__(self, model, u, f):
        self.model, self.u, self.f = model, u, f

    def surface_mean(self, region, axis):
        weights = self.model.mesh.surface_weights(self.model.mesh.faces(region), self.model.order)
        return sum(w * self.u[n][axis] for n, w in weights.items()) / sum(weights.values())

    def volume_mean(self, axis):
        weights = self.model.mesh.volume_weights(self.model.order)
        return sum(w * self.u[n][axis] for n, w in weights.items()) / sum(weights.values())

    def at(self, point, axis):
        found = self.model.mesh.select(lambda *at: math.dist(at, point) < 1e-6, self.model.order)
        if len(found) != 1:
            raise RuntimeError(f'no node at {point}')
        return self.u[found[0]][axis]

    def line_mean(self, region, along, axis):
        """Mean over a line of element edges; nodes sorted by coordinate `along` alternate corner, middle, corner."""
        nodes = sorted(self.model.mesh.select(region, self.model.order), key=lambda n: self.model.mesh.nodes[n][along])
        total = 0.0
        for a, b, c in zip(nodes[0::2], nodes[1::2], nodes[2::2]):
            length = self.model.mesh.nodes[c][along] - self.model.mesh.nodes[a][along]
            total += length * (self.u[a][axis] + 4 * self.u[b][axis] + self.u[c][axis]) / 6
        return total / (self.model.mesh.nodes[nodes[-1]][along] - self.model.mesh.nodes[nodes[0]][along])

    def force(self, region, axis):
        """Sum of what the support exerts on the body in the region."""
        return sum(self.f[n][axis] for n in self.model.mesh.select(region, self.model.order))

    def torque(self, region, axis):
        """The same about the coordinate axis through the origin, at the deformed positions."""
        i, j = (axis + 1) % 3, (axis + 2) % 3
        total = 0.0
        for n in self.model.mesh.select(region, self.model.order):
            x = [a + b for a, b in zip(self.model.mesh.nodes[n], self.u[n])]
            total += x[i] * self.f[n][j] - x[j] * self.f[n][i]
        return total
