# SPDX-License-Identifier: Apache-2.0
"""Curved bodies as mapped blocks: balls (a core and shells around it), rings, cylinders."""
import math

from mesh import Mesh, graded, uniform


def _blend(inner, outer, s):
    return tuple(a + s * (b - a) for a, b in zip(inner, outer))


def ball_part(level, sides, core, outer, rim=1.0, size=1.0, layers=1):
    """Core block and shells around it. The core is the image of -1..1, or 0..1 where `sides` lacks the lower side, in p, q
    and r; `core(p, q, r)` and `outer(p, q, r)` place points of the block and of its surface.

    @param sides  which sides of the block carry a shell, of '+x', '-x', '+y', '-y', '+z', '-z'
    @param rim    relative size of elements towards r = 0 and the outer surface, where the rim of a bonded face may be
    @param layers elements along r in the core per level
    """
    def breaks(axis):
        low = -1.0 if '-' + axis in sides else 0.0
        count = 2 * level if low < 0 else level
        if axis == 'z' and low == 0.0:
            return graded(0.0, 1.0, layers * count, start=rim)
        return uniform(low, 1.0, count)

    us, vs, ws = breaks('x'), breaks('y'), breaks('z')
    mesh = Mesh(merge=1e-6 * size)
    mesh.block(us, vs, ws, core)
    ss = graded(0.0, 1.0, 2 * level, end=rim)
    for side in sides:
        end = 1.0 if side[0] == '+' else -1.0
        if side[1] == 'x':
            place, a, b = (lambda s, v, w, end=end: (end, v, w)), vs, ws
        elif side[1] == 'y':
            place, a, b = (lambda s, u, w, end=end: (u, end, w)), us, ws
        else:
            place, a, b = (lambda s, u, v, end=end: (u, v, end)), us, vs

        def shell(s, first, second, place=place):
            at = place(s, first, second)
            return _blend(core(*at), outer(*at), s)

        mesh.block(ss, a, b, shell)
    return mesh


def bulged_core(half, p, q, r):
    """A cube of half width `half` whose faces bulge a little towards the sphere: better angles at its corners."""
    bulge = 1.0 + 0.25 * (1.0 - (p * p + q * q + r * r) / 3.0)
    return half * p * bulge, half * q * bulge, half * r * bulge


def sphere_point(p, q, r):
    """Unit vector by equal angles from the surface of the cube."""
    t = [math.tan(0.25 * math.pi * c) for c in (p, q, r)]
    length = math.hypot(*t)
    return tuple(c / length for c in t)


def half_ball(level, radius):
    """z >= 0; the half y >= 0 of it."""
    return ball_part(level, ('+x', '-x', '+y', '+z'), lambda p, q, r: bulged_core(0.42 * radius, p, q, r),
                     lambda p, q, r: tuple(radius * c for c in sphere_point(p, q, r)), rim=0.35, size=radius)


def ball(level, radius):
    return ball_part(level, ('+x', '-x', '+y', '-y', '+z', '-z'), lambda p, q, r: bulged_core(0.42 * radius, p, q, r),
                     lambda p, q, r: tuple(radius * c for c in sphere_point(p, q, r)), size=radius)


def hanging_ellipsoid(level, axes, cut):
    """Ellipsoid below the plane z = cut * axes[2], the quarter x, y >= 0 of it; r = 0 is the plane, r = 1 the bottom."""
    stretch = (math.pi - math.acos(cut)) / (0.5 * math.pi)  # of angles from the lower pole, plane at a quarter turn
    half, depth = 0.5 * math.sqrt(1.0 - cut * cut), 0.65 + 0.6 * cut

    def core(p, q, r):
        x, y, z = bulged_core(1.0, p, q, r)
        return half * x * axes[0], half * y * axes[1], (cut - depth * z) * axes[2]

    def outer(p, q, r):
        x, y, z = sphere_point(p, q, r)
        ring, angle = math.hypot(x, y), math.acos(min(1.0, max(-1.0, z))) * stretch
        x, y = (x / ring, y / ring) if ring > 0.0 else (0.0, 0.0)
        return math.sin(angle) * x * axes[0], math.sin(angle) * y * axes[1], -math.cos(angle) * axes[2]

    return ball_part(level, ('+x', '+y', '+z'), core, outer, rim=0.02, size=max(axes), layers=2)


def ring_quarter(level, radius, width, half):
    """Arc of 90 degrees about z from the x axis (finer there) to the y axis, square section; half: z >= 0 only."""
    a = 0.5 * width
    rs = graded(radius - a, radius + a, 2 * level, 0.5, 0.5)
    angles = graded(0.0, 0.5 * math.pi, 7 * level, start=0.3)
    zs = graded(0.0, a, level, end=0.5) if half else graded(-a, a, 2 * level, 0.5, 0.5)
    mesh = Mesh(merge=1e-6 * radius)
    return mesh.block(rs, angles, zs, lambda r, t, z: (r * math.cos(t), r * math.sin(t), z))


def half_tube(level, inner, outer, length):
    """About x, from 0 (finer there) to length; y >= 0 of it."""
    mesh = Mesh(merge=1e-6 * outer)
    xs = graded(0.0, length, 8 * level, start=0.25)
    return mesh.block(xs, graded(inner, outer, level, 0.5, 0.5), uniform(-0.5 * math.pi, 0.5 * math.pi, 4 * level),
                      lambda x, r, t: (x, r * math.cos(t), r * math.sin(t)))


def cylinder(level, radius, length):
    """About z, from 0 to length: a core and four shells."""
    mesh = Mesh(merge=1e-6 * radius)
    zs, half = uniform(0.0, length, 3 * level), 0.45 * radius
    sides = uniform(-1.0, 1.0, 2 * level)

    def core(p, q):
        bulge = 1.0 + 0.2 * (1.0 - 0.5 * (p * p + q * q))
        return half * p * bulge, half * q * bulge

    mesh.block(sides, sides, zs, lambda p, q, z: (*core(p, q), z))
    for turn in range(4):
        c, s = ((1, 0), (0, 1), (-1, 0), (0, -1))[turn]

        def shell(t, q, z, c=c, s=s):
            angle = 0.25 * math.pi * q
            x, y = _blend(core(1.0, q), (radius * math.cos(angle), radius * math.sin(angle)), t)
            return c * x - s * y, s * x + c * y, z

        mesh.block(uniform(0.0, 1.0, level), sides, zs, shell)
    return mesh
