# SPDX-License-Identifier: Apache-2.0
"""What cases are made of. Every quantity is in SI units; regions and keys of `parameters` are those of a scene file.

A reaction is what the support exerts on the body. Half and quarter models use the symmetry of the case; values are of the
whole body.
"""
from collections import namedtuple

from model import Material

ALL = []
Quantity = namedtuple('Quantity', 'name text unit measure analytic', defaults=(None,))
Case = namedtuple('Case', 'name law solver check levels check_levels build quantities parameters')

E, NU, RHO = 1e4, 0.3, 1000.0
FACE = 1e-6       # half thickness of a region that means a face, m
EVERYWHERE = 1.0  # half size of a region that is meant to reach past the body
PRINTED_NAMES = {'neo_hookean_mixed': 'neo_hookean'}


def add(name, law, build, quantities, parameters, solver=None, check=None, levels=(2, 3, 4),
        check_levels=None):
    """`build(level, order, law)` makes the model. CalculiX has `stvk` and `linear`, truth_fem the rest.

    The check by the other program stops at the middle level unless `check_levels` says otherwise: its 27-node elements
    are then about as good as the finest ones of 20 nodes. Where a singular edge rules, it needs all levels and the limit.
    """
    solver = solver or ('calculix' if law in ('stvk', 'linear') else 'truth_fem')
    ALL.append(Case(name, PRINTED_NAMES.get(law, law), solver, check, levels,
                    check_levels or levels[:2], lambda level, order: build(level, order, law),
                    quantities, parameters))


def slab(axis, low, high):
    """Region between two planes across an axis, as a scene file writes it."""
    minimum, maximum = [-EVERYWHERE] * 3, [EVERYWHERE] * 3
    minimum[axis], maximum[axis] = low, high
    return {'box': {'min': minimum, 'max': maximum}}


def plane(axis, value):
    """The same for a flat face: so thin that no volume and no strip of the neighbouring faces counts."""
    return slab(axis, value - FACE, value + FACE)


def on(axis, value):
    """Predicate of nodes."""
    return lambda *at: abs(at[axis] - value) < 1e-7


def material(law, youngs_modulus=E, poisson_ratio=NU):
    return Material(law, youngs_modulus, poisson_ratio, RHO)


def properties(youngs_modulus=E, poisson_ratio=NU):
    return {'youngs_modulus': youngs_modulus, 'poisson_ratio': poisson_ratio, 'density': RHO}


def body(low, high):
    return {'shape': 'box', 'min': low, 'max': high}
