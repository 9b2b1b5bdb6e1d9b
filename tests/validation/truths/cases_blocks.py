# SPDX-License-Identifier: Apache-2.0
"""Blocks between bonded plates, and under a patch."""
from case import E, FACE, NU, Quantity, add, body, material, on, plane, properties
from mesh import box, graded, uniform
from model import Model


def cube(level, order, law, move, nu=NU, increment=0.25, even=False):
    """0.1 m; bottom bonded, top bonded to a plate that moves by `move`; quarter or half by symmetry.

    `even`: elements of equal size, `level` over half the width. St. Venant-Kirchhoff collapses at the singular edges of the
    plates in compression once elements are small enough there, so that case is not graded.
    """
    sideways = move[0] != 0.0
    if even:
        breaks = (uniform(0.0, 0.05, level), uniform(0.0, 0.05, level), uniform(0.0, 0.1, 2 * level))
        model = Model(box((0, 0, 0), (0.1, 0.1, 0.1), breaks), [material(law, E, nu)], order, increment=0.1)
        return compress(model, move)
    xs = graded(-0.05, 0.05, 4 * level, 0.3, 0.3) if sideways else graded(0.0, 0.05, 2 * level, end=0.3)
    ys = graded(0.0, 0.05, 2 * level, end=0.3)
    zs = graded(0.0, 0.1, 4 * level, 0.3, 0.3)
    model = Model(box((0, 0, 0), (0.1, 0.1, 0.1), (xs, ys, zs)), [material(law, E, nu)], order, increment=increment)
    return compress(model, move)


def compress(model, move):
    model.hold(on(2, 0.0))
    model.hold(on(2, 0.1), lambda at, t: tuple(t * m for m in move))
    model.mirror(*((1,) if move[0] else (0, 1)))
    return model


def cube_quantities(move):
    if move[0]:
        return [Quantity('force_x', 'force along x on the plate', 'N', lambda r: 2 * r.force(on(2, 0.1), 0)),
                Quantity('force_z', 'force along z on the plate', 'N', lambda r: 2 * r.force(on(2, 0.1), 2))]
    line = lambda x, y, z: abs(x - 0.05) < 1e-7 and abs(z - 0.05) < 1e-7
    return [Quantity('force_z', 'force along z on the plate', 'N', lambda r: 4 * r.force(on(2, 0.1), 2)),
            Quantity('bulge', 'mean u_x of the line x = 0.05, z = 0.05 m (middle height of a side face)', 'm',
                     lambda r: r.line_mean(line, 1, 0))]


def cube_parameters(move, nu=NU):
    return {'body': body([-0.05, -0.05, 0], [0.05, 0.05, 0.1]), **properties(E, nu),
            'fix': [{'region': plane(2, 0.0)}, {'region': plane(2, 0.1), 'displacement': list(move)}]}


def levels_of(law, move):
    """Half models of 27-node elements are good enough, and costly enough, one level earlier."""
    return (1, 2, 3) if move[0] and law != 'stvk' else (2, 3, 4)


def add_cubes():
    moves = {'compressed_20': (0.0, 0.0, -0.02), 'stretched_20': (0.0, 0.0, 0.02), 'sheared_20': (0.02, 0.0, 0.0)}
    for law in ('stvk', 'neo_hookean', 'corotated'):
        for name, move in moves.items():
            even = law == 'stvk' and name == 'compressed_20'
            add(f'cube_{name}.{law}', law,
                lambda level, order, law, move=move, even=even: cube(level, order, law, move, even=even),
                cube_quantities(move), cube_parameters(move), check='truth_fem' if law == 'stvk' else None,
                levels=(3, 4, 6) if even else levels_of(law, move))
    moves = {'compressed_10': (0.0, 0.0, -0.01), 'sheared_10': (0.01, 0.0, 0.0)}
    for nu in (0.3, 0.45, 0.49, 0.4999):
        law = 'neo_hookean' if nu == 0.3 else 'neo_hookean_mixed'
        for name, move in moves.items():
            add(f'cube_{name}_nu{nu:g}.neo_hookean', law,
                lambda level, order, law, move=move, nu=nu: cube(level, order, law, move, nu, 0.5),
                cube_quantities(move), cube_parameters(move, nu), levels=levels_of(law, move))


# A square patch bonded to a rigid punch that moves straight down ------------------------------------------------------

def indented(level, order, law, depth, nu):
    """0.1 x 0.1 x 0.05 m, the quarter x, y >= 0; finer towards the edges of the patch of 0.03 m."""
    xs = graded(0.0, 0.015, 2 * level, end=0.05)[:-1] + graded(0.015, 0.05, 3 * level, start=0.02)
    zs = graded(0.0, 0.05, 4 * level, end=0.02)
    model = Model(box((0, 0, 0), (0.05, 0.05, 0.05), (xs, xs, zs)), [material(law, E, nu)], order, increment=0.2)
    model.hold(on(2, 0.0))
    model.hold(on_patch, lambda at, t: (0.0, 0.0, -depth * t))
    model.mirror(0, 1)
    return model


def embedded(level, order, law, thickness, depth):
    """The same with a bonded layer of material below the patch, which moves with the punch."""
    xs = graded(0.0, 0.015, 2 * level, end=0.05)[:-1] + graded(0.015, 0.05, 3 * level, start=0.02)
    zs = graded(0.0, 0.05 - thickness, 4 * level, end=0.02)[:-1] + graded(0.05 - thickness, 0.05, level)
    model = Model(box((0, 0, 0), (0.05, 0.05, 0.05), (xs, xs, zs)), [material(law)], order, increment=0.2)
    model.hold(on(2, 0.0))
    model.hold(lambda *at: in_punch(at, thickness), lambda at, t: (0.0, 0.0, -depth * t))
    model.mirror(0, 1)
    return model


def in_punch(at, thickness):
    return max(abs(at[0]), abs(at[1])) < 0.015 + 1e-7 and at[2] > 0.05 - thickness - 1e-7


def add_embedded_punches():
    depth = 0.002
    for thickness in (0.0012, 0.003):
        add(f'embedded_punch_{thickness * 1e3:g}mm.neo_hookean', 'neo_hookean',
            lambda level, order, law, thickness=thickness: embedded(level, order, law, thickness, depth),
            [Quantity('force_z', 'force along z on the held layer', 'N',
                      lambda r, thickness=thickness: 4 * r.force(lambda *at: in_punch(at, thickness), 2))],
            {'body': body([-0.05, -0.05, 0], [0.05, 0.05, 0.05]), **properties(),
             'fix': [{'region': plane(2, 0.0)},
                     {'region': {'box': {'min': [-0.015, -0.015, 0.05 - thickness], 'max': [0.015, 0.015, 0.06]}},
                      'displacement': [0, 0, -depth]}]}, levels=(1, 2, 3))


def on_patch(x, y, z):
    return abs(z - 0.05) < 1e-7 and abs(x) < 0.015 + 1e-7 and abs(y) < 0.015 + 1e-7


def add_indentations():
    # St. Venant-Kirchhoff turns inside out under the edge of the punch: at 2 mm and more its force has no limit.
    for law, depth in (('stvk', 0.0005), ('neo_hookean', 0.002), ('neo_hookean', 0.005)):
        for nu in (0.3, 0.45):
            add(f'indentation_{depth * 1e3:g}mm_nu{nu:g}.{law}', 'neo_hookean_mixed' if law != 'stvk' and nu > 0.4 else law,
                lambda level, order, law, depth=depth, nu=nu: indented(level, order, law, depth, nu),
                [Quantity('force_z', 'force along z on the patch', 'N', lambda r: 4 * r.force(on_patch, 2))],
                {'body': body([-0.05, -0.05, 0], [0.05, 0.05, 0.05]), **properties(E, nu),
                 'fix': [{'region': plane(2, 0.0)},
                         {'region': {'box': {'min': [-0.015, -0.015, 0.05 - FACE], 'max': [0.015, 0.015, 0.05 + FACE]}},
                          'displacement': [0, 0, -depth],
                          'note': 'only the patch of the upper face is held, no volume'}]},
                check='truth_fem' if law == 'stvk' else None, levels=(1, 2, 3), check_levels=(1, 2, 3))
