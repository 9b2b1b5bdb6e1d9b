# SPDX-License-Identifier: Apache-2.0
"""Simulations: opening, running, parameters, states."""

import ctypes as c
import json
import os
import threading
import time
import weakref
from typing import Any, Callable, Dict, List, NamedTuple, Optional, Sequence, Tuple, Union

from . import _library as _l
from ._bodies import Body
from ._calls import POLL_S, ReportedCall, _InterruptibleCall
from ._images import WarpedImage, warp
from ._library import Error, check, lib
from ._pictures import Pictures
from ._recording import Recording, Replayed, repeat, run_options
from ._values import Path, Value, _file, _text

_SHORT_S = 0.02  # calls that are expected to be shorter run on the calling thread


class Status(NamedTuple):
    """State of a simulation.

    - steps: since the initial state
    - time: simulated, s; 0 of a quasi-static solution
    - dt: size of the next step, s
    - bodies: their number
    - stopped: number of bodies that stay in their last good state
    - finished: the solution is complete; further steps have no effect
    - quasistatic: steps increase the load
    - wall: wall time spent in steps, s
    """
    steps: int
    time: float
    dt: float
    bodies: int
    stopped: int
    finished: bool
    quasistatic: bool
    wall: float


class Parameter(NamedTuple):
    """What can be read and set while the simulation exists.

    - path: of sim[path]
    - unit: SI; empty: none
    - label: name for people
    - meaning: effect of small and large values
    - accepted: such as "0 < value < 0.5"
    """
    path: str
    unit: str
    label: str
    meaning: str
    accepted: str


class Event(NamedTuple):
    """Something that happened while the simulation ran.

    - time: simulated, s
    - kind: a word, such as "overlap" or "stopped"
    - text: what happened, to which body
    """
    time: float
    kind: str
    text: str


def open(path: Optional[Path] = None, *, text: Optional[str] = None, progress: Union[bool, Callable] = False,
         threads: int = 0, plugins: Sequence[Path] = (), plugin_folders: Sequence[Path] = (),
         search_plugins: bool = True, **values: Value) -> "Simulation":
    """Builds the simulation of a scene (.toml), a session (.c3de), a mesh or a recording (.c3dr), which begins with its
    first state: replay() repeats it.

    text: a scene as TOML that is read instead of the file; relative paths are those of the folder of `path`, or of the
    current folder. progress: True for a bar, or f(fraction, text), which returns False to cancel; it is called on
    another thread. threads: number of worker threads, 0: as many as the machine has. values: as `c3de run --set`, by
    PATH, with `**{"body.liver.youngs_modulus": 6e3}` (Pa). Ctrl-C cancels.

    Raises Error: the file, line, value and what is accepted.
    """
    file = _file(path) if path is not None else None
    if file is None and text is None:
        raise Error("path and text are missing; accepted: one of them at least", _l.E_ARG)
    assign = ["%s=%s" % (key, _text(value)) for key, value in values.items()]
    files, folders = [os.fspath(p) for p in plugins], [os.fspath(p) for p in plugin_folders]
    cancelled = threading.Event()
    reported = ReportedCall(progress)

    def report(_self: Any, fraction: float, what: bytes) -> int:
        return int(reported.report(fraction, what.decode(errors="replace")) or cancelled.is_set())

    options = _l.Options(flags=0 if search_plugins else _l.NO_PLUGIN_SEARCH, file=file,
                         text=text.encode() if text is not None else None, assign=_l.texts(assign),
                         assign_n=len(assign), plugin_files=_l.texts(files), plugin_files_n=len(files),
                         plugin_folders=_l.texts(folders), plugin_folders_n=len(folders), threads=threads,
                         progress=_l.PROGRESS(report))
    handle = c.c_uint64()

    try:
        reported.make(lambda: check(lib.c3de_embed_open(c.byref(options), c.byref(handle))), cancelled.set)
    except BaseException:
        if handle.value:  # it was complete before the interrupt
            lib.c3de_embed_close(handle)
        raise
    simulation = Simulation(handle.value, os.fspath(path) if path is not None else "text")
    simulation._program_options = [*(["--no-plugins"] if not search_plugins else []),
                                   *("--plugin=" + os.path.abspath(one) for one in files),
                                   *("--plugin-path=" + os.path.abspath(one) for one in folders)]
    return simulation


class Simulation(Pictures):
    """One simulation; made by c3de.open(). A context manager: closed at its end.

    sim[path] reads a parameter and sim[path] = value sets it, by the paths of `c3de run --set`; a number has the SI
    unit that parameters() names. Any thread may call; calls to the same simulation are serialised.
    """

    def __init__(self, handle: int, name: str):
        self._handle = handle
        self._name = name
        self._step_s: Optional[float] = None  #: wall time of a step, of the last call
        #: Around calls that change the state, and around a call and the copy of the text or memory that it returns.
        #: A callback has the lock already, on the thread of its run.
        self._lock = threading.RLock()
        self._kept: Any = None  #: what must exist as long as the simulation
        self._comps: Dict[Tuple[int, int, str], int] = {}
        self._finalizer = weakref.finalize(self, lib.c3de_embed_close, handle)

    def close(self) -> None:
        """Ends the simulation; a run of another thread is cancelled. Arrays stay valid. May be called twice.

        Raises Error of kind "state" within a function for progress; the simulation stays open then.
        """
        while not self._lock.acquire(timeout=POLL_S):
            self.cancel()
        try:
            if self._finalizer.alive:
                check(lib.c3de_embed_close(self._handle))
                self._finalizer.detach()
        finally:
            self._lock.release()

    def __enter__(self) -> "Simulation":
        return self

    def __exit__(self, *_exception: Any) -> None:
        self.close()

    def __repr__(self) -> str:
        if not self._finalizer.alive:
            return "<c3de.Simulation %r, closed>" % self._name
        now = self.status
        return "<c3de.Simulation %r, %d bodies, step %d, %g s>" % (self._name, now.bodies, now.steps, now.time)

    # Running

    @property
    def status(self) -> Status:
        """Steps, time and what else the simulator states about itself."""
        out = _l.StatusStruct()
        check(lib.c3de_embed_get_status(self._handle, c.byref(out)))
        return Status(out.steps, out.time_s, out.dt_s, out.bodies, out.stopped, bool(out.flags & _l.FINISHED),
                      bool(out.flags & _l.LOAD_STEPS), out.wall_s)

    @property
    def time(self) -> float:
        """Simulated time, s."""
        return self.status.time

    @property
    def steps(self) -> int:
        """Steps since the initial state."""
        return self.status.steps

    @property
    def state_hash(self) -> str:
        """Hash of the complete simulation state: 16 hexadecimal digits, as in the report of `c3de run`."""
        out = c.c_uint64()
        check(lib.c3de_embed_state_hash(self._handle, c.byref(out)))
        return "%016x" % out.value

    def step(self, n: int = 1) -> int:
        """Makes up to n steps and returns how many: fewer where the solution is complete. Ctrl-C cancels. Bodies that
        have stopped while others continue raise nothing: status.stopped counts them.

        Raises Error: a step failed (kind "diverged", "time limit", …); the state before it is kept, and `steps` of the
        error is the number of steps that were made.
        """
        if n < 0:
            raise Error("n is %d; accepted: >= 0" % n, _l.E_ARG)
        done = c.c_uint64()

        def call() -> None:
            with self._lock:
                begin = time.perf_counter()
                status = lib.c3de_embed_step(self._handle, n, c.byref(done))
                if done.value:
                    self._step_s = (time.perf_counter() - begin) / done.value
                try:
                    check(status)
                except Error as error:
                    error.steps = done.value
                    raise

        if self._step_s is not None and n * self._step_s < _SHORT_S:
            call()
        else:
            _InterruptibleCall(call, self.cancel).wait()
        return done.value

    def run(self, until: Optional[float] = None, *, steps: Optional[int] = None,
            progress: Union[bool, Callable[[float, str], Any]] = False) -> "Simulation":
        """Runs to an absolute simulated time (s; ignored for quasi-static solutions), for a number of steps, or to
        whichever is first; without both, until the solution is complete or to 1 s. progress: True for a bar, or
        f(fraction, text), which returns False to cancel; it is called on another thread, several times a second, and
        may read the simulation. Ctrl-C cancels; the state stays complete.

        Raises Error: as step(); kind "diverged" also where bodies have stopped early; kind "cancelled".
        """
        options, reported = run_options(until, steps, progress)

        def call() -> None:
            with self._lock:
                check(lib.c3de_embed_run(self._handle, c.byref(options)))

        reported.make(call, self.cancel)
        return self

    def cancel(self) -> None:
        """Ends the step, run, replay or warp of another thread, which then raises Error of kind "cancelled"; otherwise
        it has no effect."""
        lib.c3de_embed_cancel(self._handle)

    def reset(self) -> None:
        """Returns to the initial state, bit for bit. Raises Error of kind "state" within a function for progress."""
        with self._lock:
            check(lib.c3de_embed_reset(self._handle))

    # Parameters

    def __getitem__(self, path: str) -> Union[float, int, bool, str, Tuple[float, float, float]]:
        """A parameter by its path: a number in SI units, a text, or a vector of three numbers. Raises Error of kind
        "argument": there is no such parameter; the nearest names are in its text."""
        out = _l.ValueStruct()
        with self._lock:
            check(lib.c3de_embed_get(self._handle, path.encode(), c.byref(out)))
            text = (out.text or b"").decode()
        if out.type == _l.NUMBER:
            return out.number
        if out.type == _l.INTEGER:
            return int(out.number)
        if out.type == _l.BOOL:
            return out.number != 0.0
        if out.type == _l.VECTOR:
            return (out.vector[0], out.vector[1], out.vector[2])
        return text

    def __setitem__(self, path: str, value: Value) -> None:
        """Sets a parameter from the next step on. Raises Error of kind "argument": the value is refused, or the
        parameter takes effect only when the scene is built. Nothing has changed then."""
        text = _text(value).encode()
        with self._lock:
            check(lib.c3de_embed_set(self._handle, path.encode(), text))

    def parameters(self) -> List[Parameter]:
        """All parameters that can be read and set now, with units and accepted ranges."""
        count = c.c_uint64()
        found = []
        with self._lock:
            check(lib.c3de_embed_parameter_count(self._handle, c.byref(count)))
            for index in range(count.value):
                out = _l.ParameterStruct()
                check(lib.c3de_embed_parameter_at(self._handle, index, c.byref(out)))
                found.append(Parameter(*(text.decode() for text in (out.path, out.unit, out.label, out.meaning,
                                                                     out.accepted))))
        return found

    # The deformed scan

    def warped_image(self, *, progress: Union[bool, Callable[[float, str], Any]] = False) -> WarpedImage:
        """The image of the scene, deformed with the bodies as they are now: the voxels that `c3de run --export-image`
        writes. progress as for run(). Ctrl-C cancels.

        Raises Error of kind "argument": the scene has no image.
        """
        return warp(self, _l.IMAGE, progress)

    def warped_labels(self, *, progress: Union[bool, Callable[[float, str], Any]] = False) -> WarpedImage:
        """The label map of the scene, deformed in the same way, on the grid of the image with nearest-neighbour
        sampling. `c3de run --export-labels` writes the same voxels.

        Raises Error of kind "argument": the scene has no image, or no label map.
        """
        return warp(self, _l.LABELS, progress)

    # Recordings

    def record(self, file: Path, *, hash_every: int = 100) -> Recording:
        """Records from now on into a file (.c3dr), until Recording.end() or close(): the present state and every
        change, step, reset and loaded state, with a state hash every `hash_every` steps. Ctrl-C cancels the beginning.

        Raises Error: kind "argument", the name does not end with .c3dr, or hash_every is below 1; "state", it is being
        recorded already; "input or output", the file cannot be written.
        """
        if hash_every < 1:
            raise Error("hash_every is %d; accepted: >= 1" % hash_every, _l.E_ARG)

        def call() -> None:
            with self._lock:
                check(lib.c3de_embed_record(self._handle, _file(file), hash_every))

        _InterruptibleCall(call, self.cancel).wait()
        return Recording(self)

    def replay(self, until: Optional[float] = None, *, steps: Optional[int] = None,
               progress: Union[bool, Callable[[float, str], Any]] = False) -> Replayed:
        """Continues the recording that c3de.open() has opened: to its end, to a simulated time (s), or for a number of
        steps. Every recorded state hash is compared. progress as for run(). Ctrl-C cancels.

        Raises Error: kind "diverged", a state hash differs, with its step; "state", it was opened from no recording.
        """
        return repeat(self, until, steps, progress)

    # Bodies

    def body(self, name: str) -> Body:
        """The body with a name. Raises Error of kind "not found", with the names that there are."""
        index = c.c_uint64()
        check(lib.c3de_embed_find_body(self._handle, name.encode(), c.byref(index)))
        return Body(self, index.value)

    @property
    def bodies(self) -> List[Body]:
        """All bodies, in the order of the scene."""
        return [Body(self, index) for index in range(self.status.bodies)]

    # Events, report, states

    def _json(self, function: Any) -> Any:
        out = c.c_char_p()
        with self._lock:
            check(function(self._handle, c.byref(out)))
            text = out.value or b"null"
        return json.loads(text.decode())

    def events(self) -> List[Event]:
        """What happened while it ran, the oldest first."""
        return [Event(one.get("time_s", 0.0), one.get("kind", ""), one.get("text", ""))
                for one in self._json(lib.c3de_embed_events)]

    def report(self) -> Dict[str, Any]:
        """The report of `c3de run --report` about the present state, without measurements and volumes of skins.
        docs/user/headless.md describes its keys."""
        return self._json(lib.c3de_embed_report)

    def save_state(self, file: Path) -> None:
        """Writes the state to a file. Raises Error: the file cannot be written."""
        with self._lock:
            check(lib.c3de_embed_save_state(self._handle, _file(file)))

    def load_state(self, file: Path) -> None:
        """Returns to a state that was saved of the same scene, bit for bit.

        Raises Error: kind "format", the file is unreadable or of another scene. Nothing has changed then.
        """
        with self._lock:
            check(lib.c3de_embed_load_state(self._handle, _file(file)))

    def save_session(self, file: Path) -> None:
        """Writes scene, changes and state as a session (.c3de), for the window, `c3de run` and c3de.open().

        Raises Error: kind "input or output", the file cannot be written; "state", within a function for progress.
        """
        with self._lock:
            check(lib.c3de_embed_save_session(self._handle, _file(file)))
