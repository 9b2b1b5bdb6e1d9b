# SPDX-License-Identifier: Apache-2.0
"""Recordings: made while a simulation runs, and repeated."""

import ctypes as c
from typing import TYPE_CHECKING, Any, Callable, NamedTuple, Optional, Tuple, Union

from . import _library as _l
from ._calls import POLL_S, ReportedCall
from ._library import Error, check, lib
from ._values import Path

if TYPE_CHECKING:
    from ._simulation import Simulation

Progress = Union[bool, Callable[[float, str], Any]]


class Recording:
    """A recording that is being made; by Simulation.record(). A context manager: completed at its end."""

    def __init__(self, simulation: "Simulation"):
        self.simulation = simulation
        self._open = True

    def end(self) -> None:
        """Completes the file. May be called twice. Raises Error: what has ended the recording early, such as a full
        disk; the simulation is not affected by it. Kind "state" within a function for progress: it continues then."""
        with self.simulation._lock:
            if not self._open:
                return
            status = lib.c3de_embed_end_recording(self.simulation._handle)
            self._open = status == _l.E_STATE  # it can be ended later
            check(status)

    def __enter__(self) -> "Recording":
        return self

    def __exit__(self, *_exception: Any) -> None:
        self.end()


class Replayed(NamedTuple):
    """Progress of a replay.

    - steps: steps of the recording that were repeated
    - equal_hashes: number of state hashes that were compared and are equal
    - complete: everything is repeated
    - remark: such as "ends early, after step 300"; empty: the recording is complete
    """
    steps: int
    equal_hashes: int
    complete: bool
    remark: str


def run_options(until: Optional[float], steps: Optional[int], progress: Progress) -> Tuple[Any, ReportedCall]:
    """Options of a run or replay, and its call."""
    if until is not None and not until > 0.0:
        raise Error("until is %s s; accepted: > 0" % until, _l.E_ARG)
    if steps is not None and steps <= 0:
        raise Error("steps is %d; accepted: > 0" % steps, _l.E_ARG)
    reported = ReportedCall(progress)

    def stepped(_self: Any, status: Any, fraction: float) -> int:
        return reported.report(fraction, "%g s, step %d" % (status.contents.time_s, status.contents.steps))

    options = _l.RunOptions(max_steps=steps or 0, until_s=until or 0.0, stepped_every_s=POLL_S)
    if progress:
        options.stepped = _l.STEPPED(stepped)
    return options, reported


def repeat(simulation: "Simulation", until: Optional[float], steps: Optional[int], progress: Progress) -> Replayed:
    """The work of Simulation.replay()."""
    options, reported = run_options(until, steps, progress)
    out = _l.ReplayStruct()
    remark = [""]

    def call() -> None:
        with simulation._lock:
            check(lib.c3de_embed_replay(simulation._handle, c.byref(options), c.byref(out)))
            remark[0] = out.remark.decode()

    reported.make(call, simulation.cancel)
    return Replayed(out.steps, out.equal_hashes, bool(out.flags & _l.REPLAY_END), remark[0])


def replay(file: Path, until: Optional[float] = None, *, steps: Optional[int] = None, progress: Progress = False,
           **options: Any) -> "Simulation":
    """Repeats a recording (.c3dr) and returns its simulation as it is then, as `c3de replay --check`. Every recorded
    state hash is compared. until (s), steps: where it ends earlier. options: those of c3de.open(), except values.

    Raises Error: kind "diverged", the first state hash that differs, with its step; "format", the file is no recording.
    """
    from ._simulation import open as _open
    simulation = _open(file, **options)
    try:
        simulation.replay(until, steps=steps, progress=progress)
    except BaseException:
        simulation.close()
        raise
    return simulation
