# SPDX-License-Identifier: Apache-2.0
"""Bodies, their points and surfaces, and what holds them."""

import ctypes as c
from typing import TYPE_CHECKING, Any, Callable, Dict, List, Optional, Sequence, Tuple, Union

from . import _inverse, _library as _l
from ._conditions import Box, Condition, add as _add
from ._library import check, lib
from ._values import Path, _copy, _vector

if TYPE_CHECKING:
    import numpy

    from ._inverse import Fit, Match, Pairs, Points, Sensitivity
    from ._simulation import Simulation


class Body:
    """A body of a simulation."""

    def __init__(self, simulation: "Simulation", index: int):
        self.simulation = simulation
        self._index = index

    def _info(self) -> Any:
        out = _l.BodyStruct()
        check(lib.c3de_embed_body_at(self.simulation._handle, self._index, c.byref(out)))
        return out

    @property
    def name(self) -> str:
        """Its name in the scene."""
        with self.simulation._lock:
            return self._info().name.decode()

    @property
    def mass(self) -> float:
        """Mass, kg."""
        return self._info().mass_kg

    @property
    def volume(self) -> float:
        """Volume at rest, m³."""
        return self._info().volume_m3

    @property
    def spacing(self) -> float:
        """Mean distance of the points, m."""
        return self._info().spacing_m

    @property
    def points(self) -> "PointSet":
        """Its material points, which have the mass and the fields."""
        return PointSet(self, _l.ON_POINTS)

    @property
    def surface(self) -> "Surface":
        """Its surface mesh."""
        return Surface(self, _l.ON_SURFACE)

    def hold(self, at: Sequence[float], radius: float, *, keep_shape: bool = False, frequency: float = 0.0,
             damping_ratio: float = 0.0, max_force: float = 0.0) -> "Hold":
        """Attaches springs to the points within `radius` (m) of `at` (m, current configuration). They pull these
        towards a target: Hold.pull(). keep_shape: what is held keeps its shape; otherwise only the weighted mean
        position is controlled. frequency (Hz), damping_ratio (1: critical) and max_force (N) are chosen automatically
        where they are 0. A context manager: released at its end.

        Raises Error: kind "argument", a value is refused; "state", the body cannot be held; "unsupported", the
        simulator holds no bodies.
        """
        options = _l.HoldStruct(flags=_l.HOLD_SHAPE if keep_shape else 0, at_m=_vector(at, "at"), radius_m=radius,
                                frequency_hz=frequency, damping_ratio=damping_ratio, max_force_N=max_force)
        out = c.c_uint64()
        with self.simulation._lock:
            check(lib.c3de_embed_hold_body(self.simulation._handle, self._index, c.byref(options), c.byref(out)))
        return Hold(self.simulation, out.value)

    def add_force(self, force: Sequence[float], *, box: Optional[Box] = None,
                  vertices: Optional[Sequence[int]] = None, ramp: float = 0.0,
                  name: Optional[str] = None) -> Condition:
        """A force (N, total, magnitude up to 1e5) on a part of the surface, distributed by area. The part is the
        surface inside `box`, two corners in m, or the triangles whose corners are all among `vertices`, indices of
        surface.vertices. Both refer to the reference shape (field "reference_position"). ramp (simulated s, up to
        3600): until it is reached; without effect on quasi-static solutions, whose load factor multiplies it.

        Raises Error: kind "argument", no surface is there, or a value is refused; "state", the body cannot move;
        "unsupported", the simulator sets none. Nothing has changed then.
        """
        return _add(self, _l.FORCE, vector=force, box=box, vertices=vertices, ramp=ramp, name=name)

    def add_pressure(self, pressure: float, *, box: Optional[Box] = None, vertices: Optional[Sequence[int]] = None,
                     ramp: float = 0.0, name: Optional[str] = None) -> Condition:
        """A pressure (Pa, magnitude up to 1e7, positive into the body) along the present normal; the part as for
        add_force()."""
        return _add(self, _l.PRESSURE, pressure=pressure, box=box, vertices=vertices, ramp=ramp, name=name)

    def add_support(self, *, box: Optional[Box] = None, vertices: Optional[Sequence[int]] = None,
                    at_rest: bool = False, ramp: float = 0.0, name: Optional[str] = None) -> Condition:
        """Holds a part of the surface where it is now; at_rest: returns it to its reference position during `ramp`.
        The part and errors as for add_force()."""
        return _add(self, _l.SUPPORT, box=box, vertices=vertices, ramp=ramp, name=name,
                    flags=_l.AT_REST if at_rest else 0)

    def add_displacement(self, displacement: Sequence[float], *, box: Optional[Box] = None,
                         vertices: Optional[Sequence[int]] = None, ramp: float = 0.0,
                         name: Optional[str] = None) -> Condition:
        """Moves a part of the surface by `displacement` (m, magnitude up to 1) from where it is now, at constant
        velocity during `ramp`; the part and errors as for add_force()."""
        return _add(self, _l.DISPLACEMENT, vector=displacement, box=box, vertices=vertices, ramp=ramp, name=name)

    def match(self, points: Union["Points", Path], *, normals: Optional["Points"] = None,
              landmarks: Optional["Pairs"] = None, use: str = "judge", noise: float = 1e-3, rigid_first: bool = True,
              deform: bool = True, weight: float = 10.0, follow: bool = False,
              progress: Union[bool, Callable[[float, str], Any]] = False) -> "Match":
        """Brings the body to points measured on its surface: by a rigid motion, then by a deformation. The simulation
        is then in the matched state and continues from it.

        - points: (n, 3), m; or a file as of `c3de match --points`, in mm
        - normals: (n, 3), where they were measured; their sign has no meaning
        - landmarks: by name, the position in the body at rest and where it was measured, m
        - use: "fit", landmarks take part in the fit; "judge", they only evaluate the result
        - noise: standard deviation of a point, m, above 0
        - rigid_first: False: the position is given, and the body only deforms
        - deform: False: the rigid motion only
        - weight: points that a fitted landmark counts as in the rigid search
        - follow: start from the last match of this body, as for the next frame of a sequence
        - progress: True for a bar, or f(fraction, text), which returns False to cancel. Ctrl-C cancels

        Raises Error: kind "argument" or "format", points or a value are refused; "unsupported", the simulator matches
        no bodies; "cancelled". Nothing has changed then.
        """
        return _inverse.match_body(self, points, normals=normals, landmarks=landmarks, use=use, noise=noise,
                                   rigid_first=rigid_first, deform=deform, weight=weight, follow=follow,
                                   progress=progress)

    def fit(self, displacement: Union[Sequence[float], "numpy.ndarray", Path],
            force: Optional[Union[Sequence[float], "numpy.ndarray"]] = None, *, at: Optional[Sequence[float]] = None,
            noise: float = 0.0, progress: Union[bool, Callable[[float, str], Any]] = False) -> "Fit":
        """Fits the Young's modulus of the body, or those of its tissues, to a measured force-displacement curve. The
        simulation does not change: set sim["body.NAME.youngs_modulus"] to use the result.

        The scene prescribes either the displacement of one [[fix]], whose reaction was measured, or one force, and then
        the displacement of a material point was measured. Both are components along the prescribed one.

        - displacement: m, of the loading, in order; or a file as of `c3de fit --curve`, in mm
        - force: N
        - at: with a force: reference position of the material point, m
        - noise: standard deviation of the measurement noise, N or m; 0: not known
        - progress: as of match()

        Raises Error: kind "format", the curve or the scene is refused; "unsupported", "cancelled" as match().
        """
        return _inverse.fit_body(self, displacement, force, at=at, noise=noise, progress=progress)

    def sensitivity(self, objective: "Points") -> "Sensitivity":
        """Derivatives of an objective at the present static solution, all by one linear solve (adjoint method).

        objective: (n, 3), its derivative with respect to the displacement of each material point, for example
        2 (u - u_measured) of a sum of squares.

        Raises Error: kind "argument", another shape; "state", the solution is not static, or has contact or flow.
        """
        return _inverse.sensitivity_of(self, objective)

    def __repr__(self) -> str:
        info = self._info()
        return "<c3de.Body %r, %d points, %d triangles, %g kg>" % (self.name, info.points, info.triangles, info.mass_kg)


class PointSet:
    """Points of a body and the fields at them. An array is a read-only snapshot with memory of its own: it stays valid
    and unchanged after further steps and after the simulation is closed."""

    def __init__(self, body: Body, on: int):
        self.body = body
        self._on = on

    def __len__(self) -> int:
        info = self.body._info()
        return info.points if self._on == _l.ON_POINTS else info.surface_points

    def _fields(self) -> List[Tuple[str, str, int]]:
        """Names, units and numbers of components."""
        found: List[Tuple[str, str, int]] = []
        simulation = self.body.simulation
        with simulation._lock:
            while True:
                out = _l.FieldStruct()
                status = lib.c3de_embed_field_at(simulation._handle, self.body._index, self._on, len(found),
                                                 c.byref(out))
                if status == _l.E_NOT_FOUND and found:
                    return found
                check(status)
                found.append((out.name.decode(), out.unit.decode(), out.comps))

    @property
    def fields(self) -> Dict[str, str]:
        """Names and SI units ("1" for a ratio)."""
        return {name: unit for name, unit, _ in self._fields()}

    def field(self, name: str) -> "numpy.ndarray":
        """A field as it is now: (n,), (n, 3) for a vector, (n, 9) for a matrix (column-major), f64; unit: fields[name].

        Raises Error of kind "not found", with the names that there are; "unsupported" without numpy.
        """
        numpy = _l.numpy_module()
        simulation, index = self.body.simulation, self.body._index
        known = simulation._comps.get((index, self._on, name))
        if known is None:
            known = next((comps for one, _, comps in self._fields() if one == name), 0)
            if known:
                simulation._comps[(index, self._on, name)] = known
        rows = len(self)
        array = numpy.empty((rows,) if known <= 1 else (rows, known))
        check(lib.c3de_embed_read_field(simulation._handle, index, self._on, name.encode(), array.ctypes.data,
                                        array.nbytes))
        array.flags.writeable = False
        return array

    @property
    def position(self) -> "numpy.ndarray":
        """Positions of the points now: (n, 3), m, f64."""
        return self.field("position")

    def __repr__(self) -> str:
        return "<c3de.%s of %r, %d points>" % (type(self).__name__, self.body.name, len(self))


class Surface(PointSet):
    """The surface of a body: points and triangles."""

    @property
    def vertices(self) -> "numpy.ndarray":
        """Positions of its points: (n, 3), m."""
        return self.field("position")

    @property
    def triangles(self) -> "numpy.ndarray":
        """Indices of vertices, outwards by the right-hand rule: (m, 3), u32."""
        numpy = _l.numpy_module()
        out = _l.ArrayStruct()
        with self.body.simulation._lock:
            check(lib.c3de_embed_view_triangles(self.body.simulation._handle, self.body._index, c.byref(out)))
            return _copy(numpy, out)


class Hold:
    """Springs that hold a part of a body; made by Body.hold()."""

    def __init__(self, simulation: "Simulation", handle: int):
        self.simulation = simulation
        self._handle = handle
        self._open = True

    def pull(self, target: Sequence[float]) -> None:
        """Sets the position (m) that the hold point `at` is pulled to from now on."""
        numbers = _vector(target, "target")
        with self.simulation._lock:
            check(lib.c3de_embed_pull(self.simulation._handle, self._handle, numbers))

    def _state(self) -> Any:
        out = _l.HoldStateStruct()
        check(lib.c3de_embed_hold_read(self.simulation._handle, self._handle, c.byref(out)))
        return out

    @property
    def force(self) -> Tuple[float, float, float]:
        """Force on the body in the last step, N."""
        x, y, z = self._state().force_N
        return x, y, z

    @property
    def point(self) -> Tuple[float, float, float]:
        """Current position of the hold point `at`, m."""
        x, y, z = self._state().point_m
        return x, y, z

    def release(self) -> None:
        """Ends it. May be called twice."""
        with self.simulation._lock:
            if not self._open:
                return
            status = lib.c3de_embed_release(self.simulation._handle, self._handle)
            self._open = status < 0 and status != _l.E_STALE  # after another failure it can be released later
            check(status)

    def __enter__(self) -> "Hold":
        return self

    def __exit__(self, *_exception: Any) -> None:
        self.release()
