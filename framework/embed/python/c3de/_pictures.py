# SPDX-License-Identifier: Apache-2.0
"""Pictures and windows of a simulation. The program draws them in a process of its own, from a session in a temporary
folder: libc3de loads no OpenGL, and a fault of a graphics driver does not end this process."""

import math
import operator
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import threading
import weakref
from typing import TYPE_CHECKING, Any, List, Optional, Sequence, Tuple, Union

from . import _library as _l
from ._library import Error

if TYPE_CHECKING:
    import numpy

_Path = Union[str, "os.PathLike[str]"]

_STATUS_OF_EXIT = {2: _l.E_ARG, 3: _l.E_FORMAT, 4: _l.E_NOT_FOUND, 5: _l.E_DIVERGED, 6: _l.E_GRAPHICS, 7: _l.E_IO}
_DIVERGED = 5  # exit code; the picture is written before
_SIDE = (16, 16384)  # of a picture, pixels


def program() -> str:
    """The path of the program c3de, for its other commands: C3DE_PROGRAM, else the one of the installation that this
    package belongs to, else the one of PATH.

    Raises Error of kind "unsupported": there is none.
    """
    given = os.environ.get("C3DE_PROGRAM")
    # PREFIX/lib/python3/dist-packages/c3de/_pictures.py
    beside = pathlib.Path(__file__).resolve().parents[4] / "bin" / ("c3de.exe" if os.name == "nt" else "c3de")
    found = given if given else str(beside) if beside.exists() else shutil.which("c3de")
    if found is None or not os.path.exists(found):
        raise Error("pictures and windows need the program c3de, and %s does not exist; C3DE_PROGRAM can name the file"
                    % (given or beside), _l.E_UNSUPPORTED)
    return found


def _failure(what: str, exit_code: int, messages: str) -> Error:
    lines = [line for line in messages.splitlines() if line.startswith("c3de: error: ")] or messages.splitlines()[-3:]
    text = "; ".join(line.replace("c3de: error: ", "", 1) for line in lines)
    return Error("%s: %s" % (what, text or "the program ended with %d" % exit_code),
                 _STATUS_OF_EXIT.get(exit_code, _l.E_INTERNAL))


def _pair(values: Sequence[Any], name: str, accepted: str) -> Tuple[Any, Any]:
    if isinstance(values, str) or not hasattr(values, "__len__") or len(values) != 2:
        raise Error("%s is %r; accepted: %s" % (name, values, accepted), _l.E_ARG)
    return values[0], values[1]


def _size(values: Sequence[int]) -> str:
    accepted = "(width, height), %d to %d pixels each" % _SIDE
    try:
        width, height = (operator.index(value) for value in _pair(values, "size", accepted))
    except TypeError:
        width = height = 0
    if not all(_SIDE[0] <= value <= _SIDE[1] for value in (width, height)):
        raise Error("size is %r; accepted: %s" % (values, accepted), _l.E_ARG)
    return "%dx%d" % (width, height)


class Window:
    """A window of the program on a copy of a simulation; made by Simulation.show(wait=False). It closes at the end of
    this process at the latest. A context manager: closed at its end."""

    def __init__(self, command: List[str], folder: str):
        self._messages = pathlib.Path(folder) / "messages"
        with self._messages.open("wb") as file:
            self._process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=file)
        self._closed_here = False
        self._text = ""
        self._done = threading.Event()
        self._finalizer = weakref.finalize(self, self._end_and_remove, self._process, folder)
        threading.Thread(target=self._follow, args=(folder,), name="c3de window", daemon=True).start()

    @staticmethod
    def _end(process: "subprocess.Popen[bytes]") -> None:
        if process.poll() is None:
            process.terminate()
            process.wait()

    @classmethod
    def _end_and_remove(cls, process: "subprocess.Popen[bytes]", folder: str) -> None:
        cls._end(process)
        shutil.rmtree(folder, ignore_errors=True)

    def _follow(self, folder: str) -> None:
        # The end of the interpreter may stop this thread anywhere; the finalizer then removes the folder.
        self._process.wait()
        try:
            self._text = self._messages.read_text(errors="replace")
        except OSError:  # the finalizer was first
            pass
        shutil.rmtree(folder, ignore_errors=True)
        self._done.set()

    @property
    def is_open(self) -> bool:
        """Whether its process runs."""
        return self._process.poll() is None

    def wait(self) -> None:
        """Returns when the user has closed the window. Ctrl-C closes it.

        Raises Error: the window did not open (kind "graphics"), or its process failed.
        """
        try:
            while not self._done.wait(0.1):
                pass
        except BaseException:
            self.close()
            raise
        if self._process.returncode != 0 and not self._closed_here:
            raise _failure("the window", self._process.returncode, self._text)

    def close(self) -> None:
        """Closes it without a question. May be called twice."""
        self._closed_here = True
        self._end(self._process)
        self._done.wait()

    def __enter__(self) -> "Window":
        return self

    def __exit__(self, *_exception: Any) -> None:
        self.close()

    def __repr__(self) -> str:
        return "<c3de.Window, %s>" % ("open" if self.is_open else "closed")


class Pictures:
    """The part of Simulation that draws."""

    _program_options: Sequence[str] = ()  #: the plugins that the simulation was opened with

    def save_session(self, file: _Path) -> None:
        raise NotImplementedError

    def picture(self, size: Sequence[int] = (1280, 720), *, view: Optional[str] = None,
                camera: Optional[Sequence[float]] = None, up: Optional[str] = None, colour: Optional[str] = None,
                colour_range: Optional[float] = None, surface: Optional[str] = None,
                overlay: Optional[str] = None) -> "numpy.ndarray":
        """The present state as the window would show it: (height, width, 3), u8, RGB, the first row on top. Needs
        OpenGL, for which a software renderer is sufficient, and no display. The same state has the same picture.

        - size: (width, height), 16 to 16384 pixels each.
        - view: "3d", "axial", "sagittal", "coronal" or "four-up"; default: four-up where the scene has an image, else
          3d.
        - camera: (azimuth, elevation), degrees, -360 to 360 and -90 to 90: where the 3D view is seen from. Azimuth 0 is
          +z, or -y where z is up; 90 is +x. Default: (34, 20).
        - up: "y" or "z", the axis that points upwards; default: z beside slices, else y.
        - colour: of the bodies: "material", "displacement" (mm), "von_mises" (kPa), "contact_pressure" (kPa), "error"
          (%), "stabilisation" (%), "verified" (mm); default: as the scene states.
        - colour_range: value of the last colour, > 0, in the unit of the legend; default: chosen automatically.
        - surface: "opaque", "transparent" or "hidden"; default: as the scene states.
        - overlay: what slices show in colours: "none", "displacement", "volume_change" or a field of the points;
          default: displacement.

        The program c3de draws it from a session that is saved to a temporary folder, so that bodies are built once
        more. It is found through C3DE_PROGRAM, beside this package, or in PATH. Ctrl-C cancels.

        Raises Error: kind "argument", a value is refused; "graphics", there is no OpenGL; "unsupported", there is no
        program or no numpy; "state", within a function for progress.
        """
        numpy = _l.numpy_module()
        options = self._picture_options(size, view, camera, up, colour, colour_range, surface, overlay)
        with tempfile.TemporaryDirectory(prefix="c3de-") as folder:
            file = pathlib.Path(folder) / "picture.ppm"
            self._draw(folder, file, options)
            kind, sides, _largest, pixels = file.read_bytes().split(b"\n", 3)
        width, height = (int(side) for side in sides.split())
        return numpy.frombuffer(pixels, numpy.uint8).reshape(height, width, 3).copy()

    def save_picture(self, file: _Path, size: Sequence[int] = (1280, 720), *, view: Optional[str] = None,
                     camera: Optional[Sequence[float]] = None, up: Optional[str] = None, colour: Optional[str] = None,
                     colour_range: Optional[float] = None, surface: Optional[str] = None,
                     overlay: Optional[str] = None) -> None:
        """Writes picture() to a file, as PNG (or PPM, by the extension .ppm). Needs no numpy.

        Raises Error: as picture(); kind "input or output", the file cannot be written.
        """
        options = self._picture_options(size, view, camera, up, colour, colour_range, surface, overlay)
        with tempfile.TemporaryDirectory(prefix="c3de-") as folder:
            self._draw(folder, pathlib.Path(os.path.abspath(file)), options)

    @staticmethod
    def _picture_options(size: Sequence[int], view: Optional[str], camera: Optional[Sequence[float]],
                         up: Optional[str], colour: Optional[str], colour_range: Optional[float],
                         surface: Optional[str], overlay: Optional[str]) -> List[str]:
        options = ["--size", _size(size)]
        if camera is not None:
            accepted = "(azimuth, elevation), degrees, -360 to 360 and -90 to 90"
            try:
                azimuth, elevation = (float(angle) for angle in _pair(camera, "camera", accepted))
            except (TypeError, ValueError, OverflowError):
                azimuth = elevation = math.nan
            if not (abs(azimuth) <= 360.0 and abs(elevation) <= 90.0):
                raise Error("camera is %r; accepted: %s" % (camera, accepted), _l.E_ARG)
            options.append("--camera=%r,%r" % (azimuth, elevation))  # one word: it may begin with a minus
        for name, value in ("--view", view), ("--up", up), ("--overlay", overlay):
            if value is not None:
                options.append("%s=%s" % (name, value))
        for key, setting in ("colour", colour), ("range", colour_range), ("surface", surface):
            if setting is not None:
                options += ["--set", "view.%s=%s" % (key, setting)]
        return options

    def _draw(self, folder: str, file: pathlib.Path, options: Sequence[str]) -> None:
        session = os.path.join(folder, "state.c3de")
        command = [program(), "run", session, "--steps", "0", "-q", "--trust-plugins", "--screenshot", str(file),
                   *options, *self._program_options]
        self.save_session(session)
        before = file.stat().st_mtime_ns if file.exists() else None
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                                   text=True, errors="replace")
        try:
            _, messages = process.communicate()
        except BaseException:
            process.kill()
            process.communicate()
            raise
        is_new = file.exists() and file.stat().st_mtime_ns != before
        if process.returncode != 0 and not (process.returncode == _DIVERGED and is_new):
            raise _failure("the picture", process.returncode, messages)

    def show(self, *, wait: bool = True, play: bool = False, arguments: Sequence[str] = ()) -> Optional[Window]:
        """Opens the window of the program on a copy of the simulation as it is now; this simulation stays unchanged.

        wait: return when the user has closed the window, and return None; otherwise return a Window at once. play: the
        simulation runs on there. arguments: further options of the program, such as ("--size", "900x700"). Saving in
        the window asks for a file; c3de.open() reads it. Ctrl-C closes the window.

        Raises Error: kind "graphics", there is no display or no OpenGL (with wait=False it may come from
        Window.wait()); "unsupported", there is no program.
        """
        if sys.platform not in ("win32", "darwin") and not any(map(os.environ.get, ("DISPLAY", "WAYLAND_DISPLAY"))):
            raise Error("there is no display for a window: DISPLAY and WAYLAND_DISPLAY are empty; picture() needs none",
                        _l.E_GRAPHICS)
        executable = program()
        folder = tempfile.mkdtemp(prefix="c3de-")
        try:
            session = os.path.join(folder, "simulation.c3de")
            self.save_session(session)
            window = Window([executable, session, "--untitled", *(["--play"] if play else []), *self._program_options,
                             *arguments], folder)
        except BaseException:
            shutil.rmtree(folder, ignore_errors=True)
            raise
        if not wait:
            return window
        window.wait()
        return None
