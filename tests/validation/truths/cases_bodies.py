# SPDX-License-Identifier: Apache-2.0
"""Curved bodies: half ball, quarter ring, hanging ellipsoid, tube, cylinder; free vibrations of a cube and a ball."""
import math

from case import E, EVERYWHERE, NU, RHO, Quantity, add, body, material, on, plane, properties, slab
from curved import ball, cylinder, half_ball, half_tube, hanging_ellipsoid, ring_quarter
from mesh import box, uniform
from model import Model

BALL, BALL_GRAVITY = 0.05, 18.0
RING, RING_WIDTH = 0.1, 0.04
AXES, CUT = (0.06, 0.04, 0.03), 0.8


def bonded_half_ball(level, order, law):
    model = Model(half_ball(level, BALL), [material(law)], order, increment=0.25)
    model.hold(on(2, 0.0))
    model.mirror(1)
    model.gravity = (BALL_GRAVITY, 0.0, 0.0)
    return model


def ring(level, order, law, force):
    model = Model(ring_quarter(level, RING, RING_WIDTH, force[2] == 0.0), [material(law)], order, increment=0.2)
    model.hold(on(1, 0.0))
    if force[2] == 0.0:
        model.mirror(2)
    model.load(on(0, 0.0), [f / RING_WIDTH ** 2 for f in force])
    return model


def ellipsoid(level, order, law):
    model = Model(hanging_ellipsoid(level, AXES, CUT), [material(law)], order, increment=0.25)
    model.hold(on(2, CUT * AXES[2]))
    model.mirror(0, 1)
    model.gravity = (0.0, 0.0, -9.81)
    return model


def add_bodies():
    for law in ('stvk', 'neo_hookean'):
        check = 'truth_fem' if law == 'stvk' else None
        add(f'half_ball.{law}', law, bonded_half_ball,
            [Quantity('top_u_x', 'u_x of the top (0, 0, 0.05)', 'm', lambda r: r.at((0.0, 0.0, BALL), 0)),
             Quantity('mean_u_x', 'mean u_x over the volume', 'm', lambda r: r.volume_mean(0)),
             Quantity('side_u_z', 'u_z of the point at 45 degrees (0.05, 0, 0.05)/sqrt(2)', 'm',
                      lambda r: r.at((BALL * math.sqrt(0.5), 0.0, BALL * math.sqrt(0.5)), 2))],
            {'body': {'shape': 'half_ball', 'centre': [0, 0, 0], 'radius': BALL, 'part': 'z >= 0'}, **properties(),
             'fix': [{'region': plane(2, 0.0)}], 'gravity': [BALL_GRAVITY, 0, 0]}, check=check,
            check_levels=(2, 3, 4))
        end = on(0, 0.0)
        for name, force in (('transverse', [0.0, 0.0, -0.02]), ('in_plane', [0.0, -0.03, 0.0])):
            add(f'ring_{name}.{law}', law, lambda level, order, law, force=force: ring(level, order, law, force),
                [Quantity(f'tip_mean_u_{"xyz"[axis]}', f'mean u_{"xyz"[axis]} of the loaded end face', 'm',
                          lambda r, axis=axis: r.surface_mean(end, axis))
                 for axis in ((2, 0) if force[2] else (1, 0))],
                {'body': {'shape': 'ring_part', 'axis': 'z', 'centreline_radius': RING, 'section': [RING_WIDTH, RING_WIDTH],
                          'from_deg': 0, 'to_deg': 90, 'note': 'angle from x towards y'}, **properties(),
                 'fix': [{'region': plane(1, 0.0)}],
                 'load': [{'region': plane(0, 0.0), 'force': force}],
                 'load_kind': 'dead traction, uniform over the end face'}, check=check, levels=(1, 2, 3),
                check_levels=(1, 2, 3))
        add(f'ellipsoid.{law}', law, ellipsoid,
            [Quantity('bottom_u_z', 'u_z of the lowest point (0, 0, -0.03)', 'm', lambda r: r.at((0.0, 0.0, -AXES[2]), 2)),
             Quantity('mean_u_z', 'mean u_z over the volume below the held cap (z < 0.024)', 'm',
                      lambda r: r.volume_mean(2))],
            {'body': {'shape': 'ellipsoid', 'centre': [0, 0, 0], 'semi_axes': list(AXES)}, **properties(),
             'fix': [{'region': slab(2, CUT * AXES[2], EVERYWHERE)}], 'gravity': [0, 0, -9.81]}, check=check,
            check_levels=(2, 3, 4))


TUBE_INNER, TUBE_OUTER, TUBE_LENGTH, TUBE_FORCE = 0.01, 0.02, 0.2, 1e-3


def bent_tube(level, order, law):
    model = Model(half_tube(level, TUBE_INNER, TUBE_OUTER, TUBE_LENGTH), [material(law)], order, increment=0.5)
    model.hold(on(0, 0.0))
    model.mirror(1)
    model.load(on(0, TUBE_LENGTH), (0.0, 0.0, -TUBE_FORCE / (math.pi * (TUBE_OUTER ** 2 - TUBE_INNER ** 2))))
    return model


def add_tube():
    end = on(0, TUBE_LENGTH)
    add('tube_shear.stvk', 'stvk', bent_tube,
        [Quantity('tip_mean_u_z', 'mean u_z of the end face', 'm', lambda r: r.surface_mean(end, 2))],
        {'body': {'shape': 'tube', 'axis': 'x', 'inner_radius': TUBE_INNER, 'outer_radius': TUBE_OUTER,
                  'length': TUBE_LENGTH}, **properties(), 'fix': [{'region': plane(0, 0.0)}],
         'load': [{'region': plane(0, TUBE_LENGTH), 'force': [0, 0, -TUBE_FORCE]}],
         'load_kind': 'dead traction, uniform over the end face'}, check='truth_fem')


def twisted_cylinder(level, order, law, angle):
    model = Model(cylinder(level, 0.02, 0.1), [material(law)], order, increment=0.5)
    model.hold(on(2, 0.0))
    c, s = math.cos(angle), math.sin(angle)
    model.hold(on(2, 0.1), lambda at, t: (c * at[0] - s * at[1] - at[0], s * at[0] + c * at[1] - at[1], 0.0))
    return model


def add_torsion():
    angle = math.radians(1.0)
    shear = E / (2 * (1 + NU))
    add('cylinder_torsion.stvk', 'stvk', lambda level, order, law: twisted_cylinder(level, order, law, angle),
        [Quantity('torque', 'torque about z on the upper face', 'N m', lambda r: r.torque(on(2, 0.1), 2),
                  shear * 0.5 * math.pi * 0.02 ** 4 * angle / 0.1)],
        {'body': {'shape': 'cylinder', 'axis': 'z', 'centre': [0, 0, 0], 'radius': 0.02, 'length': 0.1}, **properties(),
         'fix': [{'region': plane(2, 0.0)}, {'region': plane(2, 0.1), 'rotation_deg': [0, 0, 1.0], 'centre': [0, 0, 0.1]}]})


def free(mesh, order):
    model = Model(mesh, [material('linear')], order)
    model.frequencies = 18
    return model


def elastic(frequencies):
    """Without the six rigid motions, which come out near zero."""
    return [f for f in frequencies if f > 1.0]


def add_free_vibrations():
    speed = math.sqrt(E / (2 * (1 + NU)) / RHO)
    cube = [Quantity(f'f_{i}', f'natural frequency, {i + 1}. of the elastic ones', 'Hz', lambda f, i=i: elastic(f)[i],
                     omega * speed / 0.1 / (2 * math.pi))
            for i, omega in ((0, 2.8562), (2, 3.8460), (5, 3.9113), (8, 4.4429))]
    add('free_cube', 'linear',
        lambda level, order, law: free(box((0, 0, 0), (0.1, 0.1, 0.1), [uniform(-0.05, 0.05, 2 * level)] * 3), order),
        cube, {'body': body([-0.05, -0.05, -0.05], [0.05, 0.05, 0.05]), **properties()})
    sphere = [Quantity(f'f_{i}', f'natural frequency, {text}', 'Hz', lambda f, i=i: elastic(f)[i],
                       eta * speed / BALL / (2 * math.pi))
              for i, eta, text in ((0, 2.50113, 'torsional l = 2 (five)'), (5, 2.6462, 'spheroidal l = 2 (five)'))]
    add('free_ball', 'linear', lambda level, order, law: free(ball(level, BALL), order), sphere,
        {'body': {'shape': 'ball', 'centre': [0, 0, 0], 'radius': BALL}, **properties()}, levels=(1, 2, 3))
