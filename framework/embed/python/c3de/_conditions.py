# SPDX-License-Identifier: Apache-2.0
"""Supports and loads that are set while a simulation exists."""

import ctypes as c
from typing import TYPE_CHECKING, Any, Optional, Sequence, Tuple

from . import _library as _l
from ._library import Error, check, lib
from ._values import _vector

if TYPE_CHECKING:
    from ._bodies import Body

Box = Sequence[Sequence[float]]


class Condition:
    """A support or load on a part of the surface of a body; made by Body.add_force() and the like. It stays until
    remove(), also over a reset; sessions and recordings contain it."""

    def __init__(self, body: "Body", options: Any, keep: Any):
        self.body = body
        self._options, self._keep = options, keep  #: of the struct, and the memory that it refers to
        self._number = c.c_uint64()
        self._set()

    def _set(self) -> None:
        simulation = self.body.simulation
        with simulation._lock:
            check(lib.c3de_embed_set_condition(simulation._handle, self.body._index, c.byref(self._options),
                                               c.byref(self._number)))

    def change(self, value: Any, ramp: float = 0.0) -> None:
        """Sets another value: three numbers of a force (N) or displacement (m), a pressure (Pa). From the present value
        it is reached during `ramp` (simulated s).

        Raises Error: kind "argument", the value is refused, or it is a support, which has none; "closed", it was
        removed. Nothing has changed then.
        """
        if self._options.kind == _l.SUPPORT:
            raise Error("a support has no value; accepted: forces, pressures, displacements", _l.E_ARG)
        before = (tuple(self._options.vector), self._options.pressure_Pa, self._options.ramp_s)
        try:
            if self._options.kind == _l.PRESSURE:
                self._options.pressure_Pa = float(value)
            else:
                self._options.vector = _vector(value, "value")
            self._options.ramp_s = ramp
            self._set()
        except BaseException:
            self._options.vector = (c.c_double * 3)(*before[0])
            self._options.pressure_Pa, self._options.ramp_s = before[1:]
            raise

    def _state(self) -> Tuple[Tuple[float, float, float], float, str]:
        out = _l.ConditionStateStruct()
        simulation = self.body.simulation
        with simulation._lock:
            check(lib.c3de_embed_condition_read(simulation._handle, self._number, c.byref(out)))
            return (out.force_N[0], out.force_N[1], out.force_N[2]), out.area_m2, out.warning.decode()

    @property
    def force(self) -> Tuple[float, float, float]:
        """Force on the body now, N: the reaction of a support, the resultant of a load."""
        return self._state()[0]

    @property
    def area(self) -> float:
        """Area of the part in the reference, m²."""
        return self._state()[1]

    @property
    def warning(self) -> str:
        """Why it has no effect; empty: it has one."""
        return self._state()[2]

    def remove(self) -> None:
        """Removes it. Raises Error of kind "closed" where it is removed already."""
        with self.body.simulation._lock:
            check(lib.c3de_embed_remove_condition(self.body.simulation._handle, self._number))


def add(body: "Body", kind: int, *, box: Optional[Box], vertices: Optional[Sequence[int]], name: Optional[str],
        ramp: float, vector: Optional[Sequence[float]] = None, pressure: float = 0.0, flags: int = 0) -> Condition:
    """The common part of Body.add_force() and the like."""
    if (box is None) == (vertices is None):
        raise Error("box and vertices are %s; accepted: one of them" % ("missing" if box is None else "both given"),
                    _l.E_ARG)
    options = _l.ConditionStruct(kind=kind, flags=flags, pressure_Pa=pressure, ramp_s=ramp,
                                 name=name.encode() if name is not None else None)
    if vector is not None:
        options.vector = _vector(vector, "force" if kind == _l.FORCE else "displacement")
    keep = None
    if vertices is not None:
        numbers = [int(one) for one in _l.plain(vertices)]
        if any(one < 0 or one > 0xFFFFFFFF for one in numbers):
            raise Error("vertices has a negative or too large number; accepted: indices of surface.vertices", _l.E_ARG)
        keep = (c.c_uint32 * max(1, len(numbers)))(*numbers)
        options.vertices, options.vertices_n = keep, len(numbers)
    else:
        corners = list(box)  # type: ignore[arg-type]
        if len(corners) != 2:
            raise Error("box has %d corners; accepted: 2, the least and the greatest" % len(corners), _l.E_ARG)
        options.box_min_m = _vector(corners[0], "the first corner of box")
        options.box_max_m = _vector(corners[1], "the second corner of box")
    return Condition(body, options, keep)
