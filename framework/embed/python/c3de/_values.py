# SPDX-License-Identifier: Apache-2.0
"""Values, paths and arrays between Python and libc3de."""

import ctypes as c
import operator
import os
from typing import Any, Sequence, Union

from . import _library as _l
from ._library import Error

Value = Union[float, int, bool, str, Sequence[float]]
Path = Union[str, "os.PathLike[str]"]


def _text(value: Value) -> str:
    """A value as after `--set PATH=`."""
    value = _l.plain(value)
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return value
    if hasattr(value, "__index__"):
        return str(operator.index(value))  # type: ignore[arg-type]
    if hasattr(value, "__len__") or hasattr(value, "__iter__"):
        return "[" + ", ".join(_text(one) for one in value) + "]"  # type: ignore[union-attr]
    return repr(float(value))  # type: ignore[arg-type]


def _vector(values: Sequence[float], name: str) -> Any:
    numbers = [float(value) for value in values]
    if len(numbers) != 3:
        raise Error("%s has %d numbers; accepted: 3" % (name, len(numbers)), _l.E_ARG)
    return (c.c_double * 3)(*numbers)


def _file(path: Path) -> bytes:
    return os.fspath(path).encode()


def _copy(numpy: Any, view: Any) -> Any:
    rows, comps = view.shape[0], view.shape[1]
    dtype = numpy.float64 if view.dtype == _l.F64 else numpy.uint32
    shape = (rows,) if view.rank == 1 else (rows, comps)
    if rows == 0:
        array = numpy.empty(shape, dtype)
    else:
        nbytes = view.strides[0] * (rows - 1) + dtype().itemsize * comps
        memory = (c.c_char * nbytes).from_address(view.data)
        array = numpy.ndarray(shape, dtype, memory, strides=tuple(view.strides)[:view.rank]).copy()
    array.flags.writeable = False
    return array
