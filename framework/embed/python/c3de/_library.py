# SPDX-License-Identifier: Apache-2.0
"""libc3de.so through ctypes: the structs and functions of c3de/embed.h."""

import ctypes as c
import os
import pathlib
from typing import Any, List

OK = 0
E_ARG, E_UNSUPPORTED, E_NOT_FOUND, E_STALE, E_STATE = -1, -3, -5, -6, -7
E_IO, E_FORMAT, E_CANCELLED, E_TIMEOUT, E_DIVERGED = -10, -11, -12, -13, -14
E_GRAPHICS, E_INTERNAL = -15, -17
_NAMES = {-1: "argument", -2: "version", -3: "unsupported", -4: "exists", -5: "not found", -6: "closed", -7: "state",
          -8: "thread", -9: "no memory", -10: "input or output", -11: "format", -12: "cancelled", -13: "time limit",
          -14: "diverged", -15: "graphics", -16: "exception", -17: "internal"}

ON_POINTS, ON_SURFACE = 1, 2
LOAD_STEPS, FINISHED = 1, 2
NO_PLUGIN_SEARCH = 1
HOLD_SHAPE = 1
SUPPORT, DISPLACEMENT, FORCE, PRESSURE = 1, 2, 3, 4
AT_REST = 1
IMAGE, LABELS = 1, 2
VOXEL_TYPES = ("int8", "uint8", "int16", "uint16", "int32", "uint32", "float32", "float64")  # from 1 on
REPLAY_END = 1
MATCH_IN_PLACE, MATCH_RIGID_ONLY, MATCH_FIT, MATCH_CONTINUE = 1, 2, 4, 8
FIT_WATCHED = 1
NUMBER, INTEGER, BOOL, CHOICE, TEXT, VECTOR = 1, 2, 3, 4, 5, 6
U32, F64 = 5, 2


class Error(Exception):
    """What failed, with the text of the program: what is wrong, where, which value, what is accepted.

    - kind: a word: "argument", "unsupported", "not found", "closed", "state", "input or output", "format", "cancelled",
      "time limit", "diverged", "graphics", …
    - status: the code c3de_status of the library, negative
    - steps: of Simulation.step(), those made before the failure
    """

    def __init__(self, text: str, status: int = -17, steps: int = 0) -> None:
        super().__init__(text)
        self.status = status
        self.steps = steps
        self.kind = _NAMES.get(status, "unknown")

    def __reduce__(self) -> Any:
        return (Error, (self.args[0], self.status, self.steps))


class _Sized(c.Structure):
    """A struct whose first member is its size."""

    def __init__(self, **values: Any):
        super().__init__(**values)
        self.size = c.sizeof(self)


PROGRESS = c.CFUNCTYPE(c.c_int32, c.c_void_p, c.c_double, c.c_char_p)
LOG = c.CFUNCTYPE(None, c.c_void_p, c.c_int32, c.c_char_p)


class Options(_Sized):
    _fields_ = [("size", c.c_uint32), ("flags", c.c_uint32), ("file", c.c_char_p), ("text", c.c_char_p),
                ("assign", c.POINTER(c.c_char_p)), ("assign_n", c.c_uint64),
                ("plugin_files", c.POINTER(c.c_char_p)), ("plugin_files_n", c.c_uint64),
                ("plugin_folders", c.POINTER(c.c_char_p)), ("plugin_folders_n", c.c_uint64),
                ("threads", c.c_uint32), ("reserved", c.c_uint32), ("progress", PROGRESS),
                ("progress_self", c.c_void_p)]


class StatusStruct(_Sized):
    _fields_ = [("size", c.c_uint32), ("flags", c.c_uint32), ("steps", c.c_uint64), ("time_s", c.c_double),
                ("dt_s", c.c_double), ("bodies", c.c_uint64), ("generation", c.c_uint64), ("stopped", c.c_uint32),
                ("planned_steps", c.c_uint32), ("wall_s", c.c_double)]


STEPPED = c.CFUNCTYPE(c.c_int32, c.c_void_p, c.POINTER(StatusStruct), c.c_double)


class RunOptions(_Sized):
    _fields_ = [("size", c.c_uint32), ("reserved", c.c_uint32), ("max_steps", c.c_uint64), ("until_s", c.c_double),
                ("stepped", STEPPED), ("stepped_self", c.c_void_p), ("stepped_every_s", c.c_double)]


class ValueStruct(_Sized):
    _fields_ = [("size", c.c_uint32), ("type", c.c_uint32), ("number", c.c_double), ("vector", c.c_double * 3),
                ("text", c.c_char_p)]


class ParameterStruct(_Sized):
    _fields_ = [("size", c.c_uint32), ("type", c.c_uint32), ("path", c.c_char_p), ("unit", c.c_char_p),
                ("label", c.c_char_p), ("meaning", c.c_char_p), ("accepted", c.c_char_p)]


class BodyStruct(_Sized):
    _fields_ = [("size", c.c_uint32), ("reserved", c.c_uint32), ("name", c.c_char_p), ("points", c.c_uint64),
                ("surface_points", c.c_uint64), ("triangles", c.c_uint64), ("mass_kg", c.c_double),
                ("volume_m3", c.c_double), ("spacing_m", c.c_double), ("stable_dt_s", c.c_double)]


class FieldStruct(_Sized):
    _fields_ = [("size", c.c_uint32), ("comps", c.c_uint32), ("name", c.c_char_p), ("unit", c.c_char_p)]


class ArrayStruct(_Sized):
    _fields_ = [("size", c.c_uint32), ("dtype", c.c_uint32), ("data", c.c_void_p), ("rank", c.c_uint32),
                ("reserved", c.c_uint32), ("shape", c.c_uint64 * 2), ("strides", c.c_int64 * 2), ("unit", c.c_char_p),
                ("generation", c.c_uint64)]


class HoldStruct(_Sized):
    _fields_ = [("size", c.c_uint32), ("flags", c.c_uint32), ("at_m", c.c_double * 3), ("radius_m", c.c_double),
                ("frequency_hz", c.c_double), ("damping_ratio", c.c_double), ("max_force_N", c.c_double)]


class HoldStateStruct(_Sized):
    _fields_ = [("size", c.c_uint32), ("reserved", c.c_uint32), ("point_m", c.c_double * 3),
                ("target_m", c.c_double * 3), ("force_N", c.c_double * 3), ("mass_kg", c.c_double)]


class ConditionStruct(_Sized):
    _fields_ = [("size", c.c_uint32), ("flags", c.c_uint32), ("kind", c.c_uint32), ("reserved", c.c_uint32),
                ("name", c.c_char_p), ("vertices", c.POINTER(c.c_uint32)), ("vertices_n", c.c_uint64),
                ("box_min_m", c.c_double * 3), ("box_max_m", c.c_double * 3), ("vector", c.c_double * 3),
                ("pressure_Pa", c.c_double), ("ramp_s", c.c_double)]


class ConditionStateStruct(_Sized):
    _fields_ = [("size", c.c_uint32), ("reserved", c.c_uint32), ("area_m2", c.c_double), ("force_N", c.c_double * 3),
                ("warning", c.c_char_p)]


class VoxelsStruct(_Sized):
    _fields_ = [("size", c.c_uint32), ("type", c.c_uint32), ("data", c.c_void_p), ("shape", c.c_uint64 * 3),
                ("strides", c.c_int64 * 3), ("affine", c.c_double * 16), ("slope", c.c_double),
                ("intercept", c.c_double), ("unit", c.c_char_p), ("layers", c.c_uint64), ("labels", c.c_uint64)]


class LabelStruct(_Sized):
    _fields_ = [("size", c.c_uint32), ("value", c.c_uint32), ("name", c.c_char_p), ("colour", c.c_float * 3),
                ("reserved", c.c_uint32)]


class ReplayStruct(_Sized):
    _fields_ = [("size", c.c_uint32), ("flags", c.c_uint32), ("steps", c.c_uint64), ("equal_hashes", c.c_uint64),
                ("remark", c.c_char_p)]


class MatchOptions(_Sized):
    _fields_ = [("size", c.c_uint32), ("flags", c.c_uint32), ("points_m", c.c_void_p), ("normals", c.c_void_p),
                ("points_n", c.c_uint64), ("points_file", c.c_char_p), ("landmarks_m", c.c_void_p),
                ("measured_m", c.c_void_p), ("names", c.POINTER(c.c_char_p)), ("landmarks_n", c.c_uint64),
                ("noise_m", c.c_double), ("landmark_weight", c.c_double), ("progress", PROGRESS),
                ("progress_self", c.c_void_p)]


class FitOptions(_Sized):
    _fields_ = [("size", c.c_uint32), ("flags", c.c_uint32), ("displacements_m", c.c_void_p),
                ("forces_N", c.c_void_p), ("points_n", c.c_uint64), ("curve_file", c.c_char_p),
                ("watched_m", c.c_double * 3), ("noise", c.c_double), ("progress", PROGRESS),
                ("progress_self", c.c_void_p)]


def _candidates() -> List[str]:
    given = os.environ.get("C3DE_LIBRARY")
    if given:
        return [given]
    name = "c3de.dll" if os.name == "nt" else "libc3de.so.0"
    # PREFIX/lib/python3/dist-packages/c3de/_library.py
    return [str(pathlib.Path(__file__).resolve().parents[3] / name), name]


def _declare(library: c.CDLL) -> None:
    sim, text, u64, u32 = c.c_uint64, c.c_char_p, c.c_uint64, c.c_uint32
    texts, numbers = c.POINTER(c.c_char_p), c.POINTER(c.c_uint64)
    signatures = {
        "open": [c.POINTER(Options), numbers], "close": [sim],
        "parameter_count": [sim, numbers], "parameter_at": [sim, u64, c.POINTER(ParameterStruct)],
        "get": [sim, text, c.POINTER(ValueStruct)], "set": [sim, text, text],
        "get_status": [sim, c.POINTER(StatusStruct)], "step": [sim, u64, numbers],
        "run": [sim, c.POINTER(RunOptions)], "cancel": [sim], "reset": [sim], "state_hash": [sim, numbers],
        "body_at": [sim, u64, c.POINTER(BodyStruct)], "find_body": [sim, text, numbers],
        "field_at": [sim, u64, u32, u64, c.POINTER(FieldStruct)],
        "view_field": [sim, u64, u32, text, c.POINTER(ArrayStruct)],
        "read_field": [sim, u64, u32, text, c.c_void_p, u64],
        "view_triangles": [sim, u64, c.POINTER(ArrayStruct)],
        "events": [sim, texts], "report": [sim, texts], "save_state": [sim, text], "load_state": [sim, text],
        "save_session": [sim, text], "hold_body": [sim, u64, c.POINTER(HoldStruct), numbers],
        "pull": [sim, u64, c.POINTER(c.c_double)], "hold_read": [sim, u64, c.POINTER(HoldStateStruct)],
        "release": [sim, u64],
        "set_condition": [sim, u64, c.POINTER(ConditionStruct), numbers],
        "condition_read": [sim, u64, c.POINTER(ConditionStateStruct)], "remove_condition": [sim, u64],
        "warp": [sim, u32, PROGRESS, c.c_void_p, numbers], "image_voxels": [u64, u64, c.POINTER(VoxelsStruct)],
        "image_label": [u64, u64, u64, c.POINTER(LabelStruct)], "image_save": [u64, text], "image_close": [u64],
        "record": [sim, text, u64], "end_recording": [sim],
        "replay": [sim, c.POINTER(RunOptions), c.POINTER(ReplayStruct)],
        "match": [sim, u64, c.POINTER(MatchOptions), texts], "fit": [sim, u64, c.POINTER(FitOptions), texts],
        "sensitivity": [sim, u64, c.c_void_p, u64, c.c_void_p, texts],
    }
    for name, arguments in signatures.items():
        function = getattr(library, "c3de_embed_" + name)
        function.argtypes = arguments
        function.restype = c.c_int32
    library.c3de_embed_last_error.restype = c.c_char_p
    library.c3de_embed_version.restype = c.c_char_p
    library.c3de_embed_revision.restype = c.c_uint32


def _load() -> c.CDLL:
    problems = []
    for candidate in _candidates():
        try:
            library = c.CDLL(candidate)
            break
        except OSError as error:
            problems.append(str(error))
    else:
        raise ImportError("libc3de was not found: " + "; ".join(problems) +
                          "; C3DE_LIBRARY can name the file")
    if library.c3de_embed_revision() < 3:
        raise ImportError("libc3de is too old: revision %d; accepted: 3 at least" % library.c3de_embed_revision())
    _declare(library)
    return library


lib = _load()


def version() -> str:
    """Version of the library."""
    return lib.c3de_embed_version().decode()


def check(status: int) -> int:
    """Raises Error for a failure; must run on the thread of the call."""
    if status >= 0:
        return status
    text = lib.c3de_embed_last_error().decode(errors="replace")
    raise Error(text or "status %d (%s)" % (status, _NAMES.get(status, "unknown")), status)


def plain(value: Any) -> Any:
    """A number or array of numpy as a number or list of Python; other values as they are."""
    return value.tolist() if hasattr(value, "tolist") else value


def texts(values: List[str]) -> Any:
    """An array of char* for a list; None for an empty one."""
    return (c.c_char_p * len(values))(*[v.encode() for v in values]) if values else None


def numpy_module() -> Any:
    """numpy, or an Error that says how to get it."""
    try:
        import numpy
    except ImportError as error:
        raise Error("arrays need numpy, which is not installed (Debian package python3-numpy)",
                    E_UNSUPPORTED) from error
    return numpy
