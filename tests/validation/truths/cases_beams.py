# SPDX-License-Identifier: Apache-2.0
"""Beams: tip shear, twist, own weight, natural frequencies; a bar with slanted faces."""
import math

from case import E, Quantity, add, body, material, on, plane, properties
from mesh import Mesh, box, graded
from model import Model


def beam_mesh(level, length, half, slenderness=1, materials=None, width=0.04, height=0.04):
    """x from 0 (finer there) to length; y and z about zero, finer at the faces; half: y >= 0 only."""
    a, b = 0.5 * width, 0.5 * height
    xs = graded(0.0, length, 8 * level * slenderness, start=0.25)
    if materials:  # a break point at the interface, finer there too
        xs = graded(0.0, materials, 5 * level, start=0.25, end=0.4)[:-1] + graded(materials, length, 5 * level, start=0.4)
    zs = graded(-b, b, 2 * level, 0.5, 0.5)
    ys = graded(0.0, a, level, end=0.5) if half else graded(-a, a, 2 * level, 0.5, 0.5)
    of = (lambda centre: 0 if centre[0] < materials else 1) if materials else (lambda centre: 0)
    return box((0, 0, 0), (length, a, b), (xs, ys, zs), of)


def cantilever(level, order, law, length=0.2, shear=0.0, gravity=0.0, increment=1.0, slenderness=1, stiffnesses=None):
    half_length = 0.5 * length if stiffnesses else None
    mesh = beam_mesh(level, length, True, slenderness, half_length)
    model = Model(mesh, [material(law, e) for e in stiffnesses or [E]], order, increment=increment)
    model.hold(on(0, 0.0))
    model.mirror(1)
    if shear:
        model.load(on(0, length), (0.0, 0.0, shear / 0.04 ** 2))
    model.gravity = (0.0, 0.0, gravity)
    return model


def tip_quantities(length, more=()):
    end = on(0, length)
    return [Quantity('tip_mean_u_z', 'mean u_z of the end face', 'm', lambda r: r.surface_mean(end, 2)),
            Quantity('tip_centre_u_z', 'u_z of the centre of the end face', 'm', lambda r: r.at((length, 0.0, 0.0), 2)),
            Quantity('tip_mean_u_x', 'mean u_x of the end face', 'm', lambda r: r.surface_mean(end, 0)), *more]


def beam_parameters(length, **more):
    return {'body': body([0, -0.02, -0.02], [length, 0.02, 0.02]), **properties(),
            'fix': [{'region': plane(0, 0.0)}], **more}


def tip_load(length, force):
    return {'load': [{'region': plane(0, length), 'force': force}],
            'load_kind': 'dead traction, uniform over the end face'}


def add_beams():
    for law, check in (('stvk', 'truth_fem'), ('neo_hookean', None)):
        add(f'beam_shear.{law}', law, lambda level, order, law: cantilever(level, order, law, shear=-1.6e-3),
            tip_quantities(0.2), beam_parameters(0.2, **tip_load(0.2, [0, 0, -1.6e-3])), check=check)
        add(f'beam_large_shear.{law}', law,
            lambda level, order, law: cantilever(level, order, law, shear=-0.055, increment=0.125),
            tip_quantities(0.2), beam_parameters(0.2, **tip_load(0.2, [0, 0, -0.055])), check=check)
        add(f'beam_twist.{law}', law, twisted_beam,
            [Quantity('torque', 'torque about x on the end face', 'N m', lambda r: r.torque(on(0, 0.2), 0)),
             Quantity('axial_force', 'force along x on the end face', 'N', lambda r: r.force(on(0, 0.2), 0))],
            {'body': body([0, -0.02, -0.02], [0.2, 0.02, 0.02]), **properties(),
             'fix': [{'region': plane(0, 0.0)},
                     {'region': plane(0, 0.2), 'rotation_deg': [90, 0, 0], 'centre': [0.2, 0, 0],
                      'displacement': [0, 0, 0]}]}, check=check)
        # Above 1.15 m/s^2 the lower side of the clamp collapses under St. Venant-Kirchhoff: there is no solution.
        for g in (0.4, 0.7) if law == 'stvk' else (0.4, 1.0, 2.0):
            add(f'beam_sag_g{g:g}.{law}', law,
                lambda level, order, law, g=g: cantilever(level, order, law, gravity=-g,
                                                          increment=0.125 if g < 2 else 0.05),
                tip_quantities(0.2), beam_parameters(0.2, gravity=[0, 0, -g]), check=check)
        add(f'slender_beam_shear.{law}', law,
            lambda level, order, law: cantilever(level, order, law, length=0.4, shear=-1.6e-3, increment=0.5,
                                                 slenderness=2),
            tip_quantities(0.4), beam_parameters(0.4, **tip_load(0.4, [0, 0, -1.6e-3])))
    # 9.81 m/s^2 at E = 1 MPa, scaled to the usual E: what benchmarks compare with.
    for law in ('neo_hookean', 'corotated'):
        add(f'beam_sag_g0.0981.{law}', law,
            lambda level, order, law: cantilever(level, order, law, gravity=-0.0981, increment=0.5),
            tip_quantities(0.2), beam_parameters(0.2, gravity=[0, 0, -0.0981]))
    add('beam_frequencies', 'linear', vibrating_beam,
        [Quantity(f'f_{kind}', f'natural frequency, {text}', 'Hz', lambda f, i=i: f[i])
         for i, kind, text in ((0, 'bending_1', 'first bending (a pair)'), (2, 'torsion_1', 'first torsion'),
                               (3, 'bending_2', 'second bending (a pair)'), (5, 'axial_1', 'first axial'))],
        beam_parameters(0.2), levels=(2, 3, 4))


def twisted_beam(level, order, law):
    xs = graded(0.0, 0.2, 6 * level, 0.3, 0.3)
    zs = graded(-0.02, 0.02, 2 * level, 0.5, 0.5)
    model = Model(box((0, 0, 0), (0.2, 0.02, 0.02), (xs, zs, zs)), [material(law)], order,
                  stages=[0.0] * 4)
    model.hold(on(0, 0.0))

    def turn(at, t):
        c, s = math.cos(0.5 * math.pi * t), math.sin(0.5 * math.pi * t)
        return 0.0, c * at[1] - s * at[2] - at[1], s * at[1] + c * at[2] - at[2]

    model.hold(on(0, 0.2), turn)
    return model


def vibrating_beam(level, order, law):
    model = Model(beam_mesh(level, 0.2, False), [material(law)], order)
    model.hold(on(0, 0.0))
    model.frequencies = 8
    return model


# A flat beam under pressure that follows it, and under the same force as dead load ------------------------------------

def pressed_beam(level, order, law, pressure, follows):
    """0.2 x 0.04 x 0.02 m, y >= 0 of it; the load is on the upper face z = 0.01."""
    xs = graded(0.0, 0.2, 10 * level, start=0.25)
    mesh = box((0, 0, 0), (0.2, 0.02, 0.01),
               (xs, graded(0.0, 0.02, level, end=0.5), graded(-0.01, 0.01, 2 * level, 0.6, 0.6)))
    model = Model(mesh, [material(law)], order, increment=0.1)
    model.hold(on(0, 0.0))
    model.mirror(1)
    if follows:
        model.press(on(2, 0.01), pressure)
    else:
        model.load(on(2, 0.01), (0.0, 0.0, -pressure))
    return model


def tip_angle(result):
    """Turn of the line through the end face from bottom to top, degrees."""
    rise = [result.at((0.2, 0.0, 0.01), axis) - result.at((0.2, 0.0, -0.01), axis) for axis in (0, 2)]
    return math.degrees(math.atan2(rise[0], 0.02 + rise[1]))


PRESSURE = 5.0


def add_pressures():
    for name, follows in (('follower', True), ('dead', False)):
        load = {'pressure': PRESSURE} if follows else {'force': [0, 0, -PRESSURE * 0.2 * 0.04]}
        for law in ('stvk', 'neo_hookean'):
            add(f'pressure_{name}.{law}', law,
                lambda level, order, law, follows=follows: pressed_beam(level, order, law, PRESSURE, follows),
                tip_quantities(0.2, [Quantity('tip_angle', 'turn of the end face about y, downwards', 'deg', tip_angle)]),
                {'body': body([0, -0.02, -0.01], [0.2, 0.02, 0.01]), **properties(), 'fix': [{'region': plane(0, 0.0)}],
                 'load': [{'region': plane(2, 0.01), **load}],
                 'load_kind': 'pressure normal to the deformed face' if follows
                 else 'dead traction, uniform over the upper face'},
                check='truth_fem' if law == 'stvk' else None, levels=(1, 2, 3))


# A bar whose section is a parallelogram ---------------------------------------------------------------------------------

SLANT = math.tan(math.radians(30.0))  # of y over z


def slanted_bar(level, order, law):
    lines = graded(-0.02, 0.02, 2 * level, 0.5, 0.5)
    mesh = Mesh(merge=1e-7).block(graded(0.0, 0.2, 8 * level, start=0.25), lines, lines,
                                  lambda x, y, z: (x, y + SLANT * z, z))
    model = Model(mesh, [material(law)], order, increment=0.5)
    model.hold(on(0, 0.0))
    model.load(on(0, 0.2), (0.0, 0.0, -1.6e-3 / 0.04 ** 2))
    return model


def add_slanted_bar():
    end = on(0, 0.2)
    add('slanted_bar_shear.stvk', 'stvk', slanted_bar,
        [Quantity(f'tip_mean_u_{"xyz"[axis]}', f'mean u_{"xyz"[axis]} of the end face', 'm',
                  lambda r, axis=axis: r.surface_mean(end, axis)) for axis in (2, 1)],
        {'body': {'shape': 'slanted_bar', 'low': [0, -0.02, -0.02], 'high': [0.2, 0.02, 0.02],
                  'note': 'a box whose points are displaced along y by tan 30° z'}, **properties(),
         'fix': [{'region': plane(0, 0.0)}], **tip_load(0.2, [0, 0, -1.6e-3])}, check='truth_fem', levels=(1, 2, 3))


# The beam of two materials --------------------------------------------------------------------------------------------

def add_two_materials():
    for law in ('stvk', 'neo_hookean'):
        add(f'two_material_beam.{law}', law,
            lambda level, order, law: cantilever(level, order, law, shear=-1.6e-3, stiffnesses=[E, 10 * E]),
            tip_quantities(0.2),
            beam_parameters(0.2, **tip_load(0.2, [0, 0, -1.6e-3]),
                            materials=[{'region': {'half_space': {'point': [0.1, 0, 0], 'normal': [1, 0, 0]}},
                                        **properties()},
                                       {'region': {'half_space': {'point': [0.1, 0, 0], 'normal': [-1, 0, 0]}},
                                        **properties(10 * E)}]),
            check='truth_fem' if law == 'stvk' else None)
