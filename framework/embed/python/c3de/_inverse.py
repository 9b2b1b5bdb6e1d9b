# SPDX-License-Identifier: Apache-2.0
"""Matching of bodies to measurements, stiffness from curves, sensitivities. Not for clinical use."""

import ctypes as c
import json
import os
from typing import TYPE_CHECKING, Any, Callable, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple, Union

from . import _library as _l
from ._calls import ReportedCall
from ._library import Error, check, lib
from ._values import Path, Value, _file, _vector

if TYPE_CHECKING:
    import numpy

    from ._bodies import Body
    from ._simulation import Simulation

Points = Union["numpy.ndarray", Sequence[Sequence[float]]]
Pairs = Mapping[str, Tuple[Sequence[float], Sequence[float]]]
Progress = Union[bool, Callable[[float, str], Any]]


class Match(NamedTuple):
    """The result of matching a body to measured points. Not for clinical use.

    - verdict: "found"; "given", the position was given; "unexplained", the noise does not explain the residual of the
      rigid motion; "ambiguous", several motions fit equally well; "refused", none is credible. The body is in the
      matched state in the first three cases only
    - motion: (4, 4) list, from the body at rest to what was measured; lengths in m
    - candidates: the motion before the deformation, then those that fit equally well, as `motion`
    - rms: of the distances between points and surface, m: "before", "rigid", and "after" where the body was deformed
    - landmark_errors: m, "before", "rigid", "after", each with "mean", "sd", "max"; None without landmarks
    - converged: the result can be used and its iterations have converged
    - expected_error: m, of the deformation, root mean square over the body, without errors of the model; None: not
      known
    - largest_expected_error: its largest value, m; None: not known
    - unknown_part: share of the body, 0 … 1, that the points hardly determine; None: not known
    - warnings: sentences
    - report: `match` of the report of `c3de match`, lengths in mm
    - body: the matched body; its fields have the displacement
    """
    verdict: str
    motion: List[List[float]]
    candidates: List[List[List[float]]]
    rms: Dict[str, float]
    landmark_errors: Optional[Dict[str, Any]]
    converged: bool
    expected_error: Optional[float]
    largest_expected_error: Optional[float]
    unknown_part: Optional[float]
    warnings: List[str]
    report: Dict[str, Any]
    body: "Body"

    @property
    def displacement(self) -> "numpy.ndarray":
        """(n, 3), m: of the material points of the body, without the rigid motion."""
        return self.body.points.field("displacement")


class Modulus(NamedTuple):
    """A fitted Young's modulus.

    - material: name of the body, or of a tissue
    - value: Pa
    - low: Pa, lower limit of the 95 % confidence interval, without errors of the model
    - high: Pa, its upper limit; inf where there is none
    - own: it was fitted separately; False: it has a common factor with the other materials of the body
    """
    material: str
    value: float
    low: float
    high: float
    own: bool


class Fit(NamedTuple):
    """The stiffness of a body from a measured curve. Not for clinical use.

    - verdict: "found"; "unexplained", the model does not have the shape of the curve; "undetermined", the interval
      extends beyond half or twice the modulus
    - moduli: one per material
    - predicted: of the fitted model at the points of the curve: N, or m where a force was prescribed
    - residual: root mean square per degree of freedom, same unit
    - converged: the iterations have converged
    - warnings: sentences
    - report: `fit` of the report of `c3de fit`
    """
    verdict: str
    moduli: List[Modulus]
    predicted: List[float]
    residual: float
    converged: bool
    warnings: List[str]
    report: Dict[str, Any]


class SupportSensitivity(NamedTuple):
    """Derivatives with respect to the prescribed motion of a [[fix]].

    - fix: its number
    - displacement: per m
    - rotation: per rad, of a small further rotation about `centre`
    - centre: m
    """
    fix: int
    displacement: Tuple[float, float, float]
    rotation: Tuple[float, float, float]
    centre: Tuple[float, float, float]


class Sensitivity(NamedTuple):
    """Derivatives of an objective at a static solution.

    - forces: (n, 3), per N, with respect to a force on each material point
    - supports: one per [[fix]] of the body
    - moduli: per Pa, by material: Young's modulus; None where a law of a plugin has its own parameters
    - surroundings_stiffness: per Pa/m, of the normal stiffness of the surroundings
    - surroundings_tangential: per Pa/m, of their tangential stiffness
    """
    forces: "numpy.ndarray"
    supports: List[SupportSensitivity]
    moduli: Dict[str, Optional[float]]
    surroundings_stiffness: float
    surroundings_tangential: float


class _Numbers:
    """Rows of numbers as contiguous memory, of numpy arrays and of lists."""

    def __init__(self, values: Any, columns: int, name: str):
        rows = [_l.plain(row) for row in _l.plain(values)]
        flat: List[float] = []
        for row in rows:
            numbers = list(row) if columns > 1 else [row]
            if len(numbers) != columns:
                raise Error("%s has a row of %d numbers; accepted: %d" % (name, len(numbers), columns), _l.E_ARG)
            flat += [float(one) for one in numbers]
        self.count = len(rows)
        self.memory = (c.c_double * max(1, len(flat)))(*flat)

    @property
    def address(self) -> Any:
        return c.cast(self.memory, c.c_void_p)


def _call(body: "Body", function: Any, options: Any, progress: Progress) -> Dict[str, Any]:
    """A long call that returns JSON."""
    simulation = body.simulation
    reported = ReportedCall(progress)
    options.progress = _l.PROGRESS(
        lambda _self, fraction, what: reported.report(fraction, what.decode(errors="replace")))
    out: List[Any] = []

    def call() -> None:
        text = c.c_char_p()
        with simulation._lock:
            check(function(simulation._handle, body._index, c.byref(options), c.byref(text)))
            out.append(json.loads((text.value or b"null").decode()))

    reported.make(call, simulation.cancel)
    return out[0]


def _triple(values: Sequence[float]) -> Tuple[float, float, float]:
    return (values[0], values[1], values[2])


def _metres(rows: List[List[float]]) -> List[List[float]]:
    return [[one if column < 3 or row == 3 else 1e-3 * one for column, one in enumerate(values)]
            for row, values in enumerate(rows)]


def _scaled(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _scaled(one) for key, one in value.items()}
    return None if value is None else 1e-3 * value


def match_body(body: "Body", points: Union[Points, Path], *, normals: Optional[Points] = None,
               landmarks: Optional[Pairs] = None, use: str = "judge", noise: float = 1e-3, rigid_first: bool = True,
               deform: bool = True, weight: float = 10.0, follow: bool = False, progress: Progress = False) -> Match:
    """Body.match()."""
    if use not in ("fit", "judge"):
        raise Error("use is %r; accepted: 'fit', 'judge'" % use, _l.E_ARG)
    if not noise > 0.0 or not weight > 0.0:
        raise Error("noise is %r and weight is %r; accepted: above 0" % (noise, weight), _l.E_ARG)
    options = _l.MatchOptions(noise_m=noise, landmark_weight=weight)
    options.flags = ((0 if rigid_first else _l.MATCH_IN_PLACE) | (0 if deform else _l.MATCH_RIGID_ONLY) |
                     (_l.MATCH_FIT if use == "fit" else 0) | (_l.MATCH_CONTINUE if follow else 0))
    keep: List[Any] = []

    def rows(values: Any, name: str) -> Any:
        keep.append(_Numbers(values, 3, name))
        return keep[-1]

    if isinstance(points, (str, os.PathLike)):
        if normals is not None:
            raise Error("normals are given with a file of points, which has its own; accepted: without them", _l.E_ARG)
        options.points_file = _file(points)
    else:
        measured = rows(points, "points")
        options.points_m, options.points_n = measured.address, measured.count
        if normals is not None:
            directions = rows(normals, "normals")
            if directions.count != measured.count:
                raise Error("normals has %d rows; accepted: %d, one per point" % (directions.count, measured.count),
                            _l.E_ARG)
            options.normals = directions.address
    if landmarks:
        options.landmarks_m = rows([pair[0] for pair in landmarks.values()], "landmarks").address
        options.measured_m = rows([pair[1] for pair in landmarks.values()], "landmarks").address
        keep.append(_l.texts(list(landmarks)))
        options.names, options.landmarks_n = keep[-1], len(landmarks)
    report = _call(body, lib.c3de_embed_match, options, progress)
    elastic = report.get("elastic") or {}
    errors = report.get("landmark_error_mm")
    return Match(report["verdict"], _metres(report["motion"]["matrix"]),
                 [_metres(one["matrix"]) for one in report["candidates"]], _scaled(report["surface_rms_mm"]),
                 _scaled(errors) if errors else None, report["converged"], _scaled(elastic.get("expected_error_mm")),
                 _scaled(elastic.get("largest_expected_error_mm")), elastic.get("unknown_part"), report["warnings"],
                 report, body)


def fit_body(body: "Body", displacement: Union[Sequence[float], "numpy.ndarray", Path],
             force: Optional[Union[Sequence[float], "numpy.ndarray"]] = None, *, at: Optional[Sequence[float]] = None,
             noise: float = 0.0, progress: Progress = False) -> Fit:
    """Body.fit()."""
    options = _l.FitOptions(noise=noise)
    keep: List[Any] = []
    if isinstance(displacement, (str, os.PathLike)):
        if force is not None:
            raise Error("force is given with a file of the curve, which has its own; accepted: without it", _l.E_ARG)
        options.curve_file = _file(displacement)
    else:
        if force is None:
            raise Error("force is missing; accepted: one value per displacement, N", _l.E_ARG)
        keep = [_Numbers(displacement, 1, "displacement"), _Numbers(force, 1, "force")]
        if keep[0].count != keep[1].count:
            raise Error("force has %d values; accepted: %d, one per displacement" % (keep[1].count, keep[0].count),
                        _l.E_ARG)
        options.displacements_m, options.forces_N = keep[0].address, keep[1].address
        options.points_n = keep[0].count
    if at is not None:
        options.flags |= _l.FIT_WATCHED
        options.watched_m = _vector(at, "at")
    report = _call(body, lib.c3de_embed_fit, options, progress)
    scale = 1e-3 if report["unit"] == "mm" else 1.0
    moduli = [Modulus(one["material"], one["youngs_modulus_Pa"], one["low_Pa"],
                      float("inf") if one["high_Pa"] is None else one["high_Pa"], one["own"])
              for one in report["moduli"]]
    return Fit(report["verdict"], moduli, [scale * one["predicted"] for one in report["curve_points"]],
               scale * report["residual"], report["converged"], report["warnings"], report)


def sensitivity_of(body: "Body", objective: Points) -> Sensitivity:
    """Body.sensitivity()."""
    numpy = _l.numpy_module()
    given = numpy.ascontiguousarray(objective, dtype=numpy.float64)
    if given.ndim != 2 or given.shape[1] != 3:
        raise Error("objective has the shape %r; accepted: (n, 3)" % (given.shape,), _l.E_ARG)
    forces = numpy.zeros(given.shape)
    text = c.c_char_p()
    with body.simulation._lock:
        check(lib.c3de_embed_sensitivity(body.simulation._handle, body._index, given.ctypes.data_as(c.c_void_p),
                                         given.shape[0], forces.ctypes.data_as(c.c_void_p), c.byref(text)))
        found = json.loads((text.value or b"null").decode())
    forces.flags.writeable = False
    supports = [SupportSensitivity(one["fix"], _triple(one["displacement"]), _triple(one["rotation"]),
                                   _triple(one["centre_m"])) for one in found["supports"]]
    return Sensitivity(forces, supports, {one["material"]: one["value"] for one in found["moduli"]},
                       found["foundation"]["stiffness"], found["foundation"]["tangential"])


def _body_of(simulation: "Simulation", body: Optional[str]) -> "Body":
    if body is not None:
        return simulation.body(body)
    bodies = simulation.bodies
    if len(bodies) != 1:
        raise Error("body is missing, and the scene has %d; accepted: one of %s" %
                    (len(bodies), ", ".join(one.name for one in bodies)), _l.E_ARG)
    return bodies[0]


def match(scene: Path, points: Union[Points, Path], *, body: Optional[str] = None,
          values: Optional[Mapping[str, Value]] = None, **options: Any) -> Match:
    """Brings a body of a scene to points measured on its surface. Match.body.simulation is the matched simulation.

    body: its name; the only one by default. values: as of c3de.open(). points and options: of Body.match().

    Raises Error as c3de.open() and Body.match().
    """
    from ._simulation import open as open_simulation
    assigned: Dict[str, Any] = dict(values or {})
    return _body_of(open_simulation(scene, **assigned), body).match(points, **options)


def fit(scene: Path, displacement: Union[Sequence[float], "numpy.ndarray", Path],
        force: Optional[Union[Sequence[float], "numpy.ndarray"]] = None, *, body: Optional[str] = None,
        values: Optional[Mapping[str, Value]] = None, **options: Any) -> Fit:
    """Fits the stiffness of a body of a scene to a measured force-displacement curve.

    body: its name; the only one by default. values: as of c3de.open(). Curve and options: of Body.fit().

    Raises Error as c3de.open() and Body.fit().
    """
    from ._simulation import open as open_simulation
    assigned: Dict[str, Any] = dict(values or {})
    with open_simulation(scene, **assigned) as simulation:
        return _body_of(simulation, body).fit(displacement, force, **options)
