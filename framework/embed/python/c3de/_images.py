# SPDX-License-Identifier: Apache-2.0
"""The scan of a scene, deformed with the bodies."""

import ctypes as c
import weakref
from typing import TYPE_CHECKING, Any, Callable, List, NamedTuple, Tuple, Union

from . import _library as _l
from ._calls import ReportedCall
from ._library import check, lib
from ._values import Path, _file

if TYPE_CHECKING:
    import numpy

    from ._simulation import Simulation


class Label(NamedTuple):
    """A label of a label map.

    - value: its number in the voxels
    - name: as the file states it, or empty
    - colour: linear RGB, 0 to 1
    """
    value: int
    name: str
    colour: Tuple[float, float, float]


class WarpedImage:
    """An image on the grid of the scan, deformed with the bodies; made by Simulation.warped_image() and
    Simulation.warped_labels(). It stays as it is when the simulation continues or is closed. Any thread.
    """

    def __init__(self, handle: int):
        self._handle = handle
        weakref.finalize(self, lib.c3de_embed_image_close, handle)

    def _voxels(self, layer: int = 0) -> Any:
        out = _l.VoxelsStruct()
        check(lib.c3de_embed_image_voxels(self._handle, layer, c.byref(out)))
        return out

    def _view(self, layer: int) -> "numpy.ndarray":
        numpy = _l.numpy_module()
        info = self._voxels(layer)
        dtype = numpy.dtype(_l.VOXEL_TYPES[info.type - 1])
        memory = (c.c_char * (info.strides[2] * info.shape[2])).from_address(info.data)
        memory._image = self  # the memory is that of the image
        array = numpy.ndarray(tuple(info.shape), dtype, memory, strides=tuple(info.strides))
        array.flags.writeable = False
        return array

    @property
    def voxels(self) -> "numpy.ndarray":
        """Stored numbers as a read-only view without a copy, indexed [i, j, k]."""
        return self._view(0)

    @property
    def array(self) -> "numpy.ndarray":
        """Values (HU of a CT), read-only, indexed [i, j, k]: `voxels` itself where slope is 1 and intercept 0. With
        other integers the values are int32 where they fit, and f64 otherwise."""
        slope, intercept = self.scale
        voxels = self.voxels
        if (slope, intercept) == (1.0, 0.0):
            return voxels
        numpy = _l.numpy_module()
        values = voxels * numpy.float64(slope) + intercept
        limits = numpy.iinfo(numpy.int32)
        if (slope.is_integer() and intercept.is_integer() and voxels.dtype.kind in "iu"
                and limits.min <= values.min() and values.max() <= limits.max):
            values = values.astype(numpy.int32)
        values.flags.writeable = False
        return values

    @property
    def layers(self) -> List["numpy.ndarray"]:
        """All layers of a label map whose labels overlap, as `voxels`; one for other images."""
        return [self._view(layer) for layer in range(self._voxels().layers)]

    @property
    def affine(self) -> "numpy.ndarray":
        """(4, 4): voxel (i, j, k, 1) to mm in RAS, as nibabel defines it."""
        numpy = _l.numpy_module()
        affine = numpy.array(self._voxels().affine[:]).reshape(4, 4)
        affine.flags.writeable = False
        return affine

    @property
    def shape(self) -> Tuple[int, int, int]:
        """Voxels along i, j, k."""
        i, j, k = self._voxels().shape
        return i, j, k

    @property
    def scale(self) -> Tuple[float, float]:
        """Slope and intercept: value = slope * voxel + intercept."""
        info = self._voxels()
        return info.slope, info.intercept

    @property
    def unit(self) -> str:
        """Unit of the values, such as "HU"; empty: the file does not state it."""
        return self._voxels().unit.decode()

    @property
    def labels(self) -> List[Label]:
        """Labels that occur in the first layer, without the background 0; none of an image that is no label map."""
        return self._labels(0)

    def _labels(self, layer: int) -> List[Label]:
        found = []
        for index in range(self._voxels(layer).labels):
            out = _l.LabelStruct()
            check(lib.c3de_embed_image_label(self._handle, layer, index, c.byref(out)))
            found.append(Label(out.value, out.name.decode(), (out.colour[0], out.colour[1], out.colour[2])))
        return found

    def save(self, file: Path) -> None:
        """Writes .nrrd, .nii, .nii.gz or .mha, as `c3de run --export-image` and `--export-labels` do. Further layers
        are written beside it as NAME-2, NAME-3, …

        Raises Error: the extension is not accepted, or the file cannot be written.
        """
        check(lib.c3de_embed_image_save(self._handle, _file(file)))

    def __repr__(self) -> str:
        info = self._voxels()
        return "<c3de.WarpedImage %d x %d x %d, %s>" % (*info.shape, _l.VOXEL_TYPES[info.type - 1])


def warp(simulation: "Simulation", what: int, progress: Union[bool, Callable[[float, str], Any]]) -> WarpedImage:
    """Deforms the image or label map of a scene. Ctrl-C cancels."""
    reported = ReportedCall(progress)
    handle = c.c_uint64()

    def report(_self: Any, fraction: float, text: bytes) -> int:
        return reported.report(fraction, text.decode(errors="replace"))

    function = _l.PROGRESS(report) if progress else _l.PROGRESS()  # type: ignore[call-overload]

    def call() -> None:
        with simulation._lock:
            check(lib.c3de_embed_warp(simulation._handle, what, function, None, c.byref(handle)))

    try:
        reported.make(call, simulation.cancel)
    except BaseException:
        lib.c3de_embed_image_close(handle)  # 0, or complete before the interrupt
        raise
    return WarpedImage(handle.value)
