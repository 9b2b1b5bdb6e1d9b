# SPDX-License-Identifier: Apache-2.0
"""One element of side 1 m, E = 1 Pa, stretched by a half with free sides: both programs against the closed form."""
import math

import calculix
import truth_fem
from mesh import box
from model import Material, Model, Result

STRETCH, NU = 1.5, 0.3


def _root(function, low, high):
    for _ in range(200):
        middle = 0.5 * (low + high)
        if function(low) * function(middle) <= 0:
            high = middle
        else:
            low = middle
    return low


def closed_form(law):
    """@return nominal stress (Pa) and stretch of the sides"""
    mu, lam = 1 / (2 * (1 + NU)), NU / ((1 + NU) * (1 - 2 * NU))
    kappa = lam + 2 * mu / 3
    a = STRETCH

    def stress(direct, other):  # principal first Piola stress for stretches direct, other, and the third
        def of(x, y, z):
            J = x * y * z
            if law == 'stvk':
                e = [(s * s - 1) / 2 for s in (x, y, z)]
                return x * (lam * sum(e) + 2 * mu * e[0])
            if law == 'corotated':
                return lam * (x + y + z - 3) + 2 * mu * (x - 1)
            if law == 'isochoric':
                return mu * J ** (-2 / 3) * (x - (x * x + y * y + z * z) / (3 * x)) + kappa * (J - 1) * J / x
            return mu * (x - 1 / x) + lam * math.log(J) / x
        return of(*direct), of(*other)

    side = _root(lambda t: stress((a, t, t), (t, t, a))[1], 0.3, 1.2)
    return stress((a, side, side), (side, side, a))[0], side


def verify(folder):
    """@return True if every law of every program agrees with the closed form to the digits it prints"""
    good = True
    for law in ('stvk', 'isochoric', 'neo_hookean', 'neo_hookean_mixed', 'corotated'):
        for solver, order in ((calculix, 20), (truth_fem, 27)):
            if order == 20 and law not in ('stvk', 'isochoric'):
                continue
            model = Model(box((0, 0, 0), (1, 1, 1), ([0, 1], [0, 1], [0, 1])), [Material(law, 1.0, NU, 1.0)], order,
                          increment=0.1)
            model.mirror(0, 1, 2)
            model.hold(lambda x, y, z: x > 0.999, lambda at, t: ((STRETCH - 1) * t, 0, 0), axes=(0,))
            u, f, _ = solver.solve(model, folder, f'verify-{law}-{order}')
            result = Result(model, u, f)
            got = result.force(lambda x, y, z: x > 0.999, 0), 1 + result.surface_mean(lambda x, y, z: y > 0.999, 1)
            wanted = closed_form(law)
            error = max(abs(g / w - 1) for g, w in zip(got, wanted))
            fits = error < (2e-6 if order == 20 else 1e-8)  # six or seven printed digits; twelve and Newton's tolerance
            good = good and fits
            print(f'{"ok  " if fits else "OFF "} {law:18s} {solver.__name__:10s} stress {got[0]:.7f} of {wanted[0]:.7f}, '
                  f'sides {got[1]:.7f} of {wanted[1]:.7f}')
    return good
