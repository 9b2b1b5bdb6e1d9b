# SPDX-License-Identifier: Apache-2.0
"""The deformed scan in Python, compared with the files of `c3de run`."""

import gc
import math
import os
import pathlib
import struct
import subprocess
import tempfile
import unittest

import c3de

try:
    import numpy
except ImportError:
    numpy = None

FALLING = pathlib.Path(os.environ["C3DE_SCENES"]) / "first_light.toml"
needs_numpy = unittest.skipIf(numpy is None, "[C3DE-SKIPPED] numpy is not installed (Debian package python3-numpy)")
SIZE = (24, 20, 16)
# Columns of i, j, k and the origin, LPS mm: turned about z, and left-handed in k.
SPACING, ANGLE = 2.0, 0.3
COLUMNS = [[SPACING * math.cos(ANGLE), SPACING * math.sin(ANGLE), 0.0],
           [-SPACING * math.sin(ANGLE), SPACING * math.cos(ANGLE), 0.0], [0.0, 0.0, -SPACING]]
ORIGIN = [10.0, -20.0, 30.0]
SCENE = """format = 1
[world]
gravity = [0, 0, 0]
[image]
file = "ct.mha"
%s
[[body]]
name = "block"
volume = "labels.mha"
label = 3
sampling = { count = 200 }
velocity = [0.3, 0.1, 0.05]
"""


def write_mha(path, kind, values):
    code = {"MET_SHORT": "h", "MET_UCHAR": "B"}[kind]
    directions = " ".join("%r" % (x / SPACING) for column in COLUMNS for x in column)
    header = ("ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\nCompressedData = False\n"
              "TransformMatrix = %s\nOffset = %s\nElementSpacing = 2 2 2\nDimSize = %d %d %d\nElementType = %s\n"
              "ElementDataFile = LOCAL\n" % (directions, " ".join(map(str, ORIGIN)), *SIZE, kind))
    path.write_bytes(header.encode() + struct.pack("<%d%s" % (len(values), code), *values))


def read_mha(path):
    """Header and numbers of a MetaImage without compression."""
    data = path.read_bytes()
    end = data.index(b"\n", data.index(b"ElementDataFile")) + 1
    header = dict(line.split(" = ", 1) for line in data[:end].decode().splitlines())
    if header.get("CompressedData") == "True":
        import zlib
        data = data[:end] + zlib.decompress(data[end:])
    dtype = {"MET_SHORT": "<i2", "MET_UCHAR": "<u1", "MET_USHORT": "<u2", "MET_INT": "<i4"}[header["ElementType"]]
    shape = [int(word) for word in header["DimSize"].split()]
    return header, numpy.frombuffer(data[end:], dtype).reshape(shape, order="F")


def index(i, j, k):
    return i + SIZE[0] * (j + SIZE[1] * k)


class Scan(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        image, labels = [], []
        for k in range(SIZE[2]):
            for j in range(SIZE[1]):
                for i in range(SIZE[0]):
                    inside = 7 <= i < 16 and 6 <= j < 14 and 5 <= k < 11
                    image.append(40 + 3 * i - 2 * j + k if inside else -1000 + i + j)
                    labels.append(3 if inside else 0)
        write_mha(self.folder / "ct.mha", "MET_SHORT", image)
        write_mha(self.folder / "labels.mha", "MET_UCHAR", labels)
        self.scene = self.folder / "scene.toml"
        self.scene.write_text(SCENE % 'labels = "labels.mha"')

    def exported(self, *options):
        subprocess.run([os.environ["C3DE_PROGRAM"], "run", str(self.scene), "--steps", "30", "-q", *options], check=True,
                       cwd=self.folder)

    @needs_numpy
    def test_image_and_labels_are_those_of_the_program(self):
        self.exported("--export-image", "i.mha", "--export-labels", "l.mha")
        with c3de.open(self.scene) as sim:
            still = sim.warped_image().array.copy()
            sim.step(30)
            image, labels = sim.warped_image(), sim.warped_labels()
        for made, name in (image, "i.mha"), (labels, "l.mha"):
            made.save(self.folder / "own.mha")
            self.assertEqual((self.folder / "own.mha").read_bytes(), (self.folder / name).read_bytes())
            header, voxels = read_mha(self.folder / name)
            self.assertTrue(numpy.array_equal(made.array, voxels))
            self.assertEqual(made.shape, SIZE)
        self.assertEqual(image.array.dtype, numpy.int16)
        self.assertTrue(numpy.array_equal(still, read_mha(self.folder / "ct.mha")[1]))
        self.assertFalse(numpy.array_equal(image.array, still))
        self.assertEqual([label.value for label in labels.labels], [3])
        self.assertEqual(labels.labels[0].name, "label 3")
        self.assertEqual(image.labels, [])
        self.assertEqual(len(labels.layers), 1)

    @needs_numpy
    def test_the_affine_leads_to_millimetres_in_ras(self):
        with c3de.open(self.scene) as sim:
            image = sim.warped_image()
        for voxel in (0, 0, 0), (5, 3, 2):
            lps = [ORIGIN[a] + sum(voxel[c] * COLUMNS[c][a] for c in range(3)) for a in range(3)]
            ras = image.affine @ [*voxel, 1.0]
            self.assertTrue(numpy.allclose(ras, [-lps[0], -lps[1], lps[2], 1.0], atol=1e-9), (ras, lps))

    @needs_numpy
    def test_an_image_outlives_steps_and_its_simulation(self):
        sim = c3de.open(self.scene)
        sim.step(10)
        array = sim.warped_image().array
        copy = array.copy()
        with self.assertRaises(ValueError):
            array[0, 0, 0] = 1
        sim.step(10)
        self.assertFalse(numpy.array_equal(sim.warped_image().array, copy))
        sim.close()
        del sim
        gc.collect()
        self.assertTrue(numpy.array_equal(array, copy))

    def test_errors_name_what_is_missing(self):
        with c3de.open(FALLING) as sim, self.assertRaises(c3de.Error) as caught:
            sim.warped_image()
        self.assertEqual(caught.exception.kind, "argument")
        self.assertIn("[image]", str(caught.exception))
        self.assertIn("first_light.toml", str(caught.exception))
        self.scene.write_text((SCENE % "").replace("volume = \"labels.mha\"\nlabel = 3", "volume = \"ct.mha\"\nthreshold = [0, 200]"))
        with c3de.open(self.scene) as sim:
            image = sim.warped_image()
            with self.assertRaises(c3de.Error) as caught:
                sim.warped_labels()
            self.assertEqual(caught.exception.kind, "argument")
            self.assertIn("labels", str(caught.exception))
            self.assertNotIn("--", str(caught.exception))
            for name, kind, text in ("a.png", "argument", ".nrrd"), ("none/a.nrrd", "input or output", "none"):
                with self.assertRaises(c3de.Error) as caught:
                    image.save(self.folder / name)
                self.assertEqual(caught.exception.kind, kind, str(caught.exception))
                self.assertIn(text, str(caught.exception))

    def test_progress_is_shown_and_cancels(self):
        seen = []
        with c3de.open(self.scene) as sim:
            sim.step(3)
            sim.warped_image(progress=lambda fraction, text: seen.append(fraction))
            self.assertTrue(seen and all(0.0 <= one <= 1.0 for one in seen))
            hash_before = sim.state_hash
            with self.assertRaises(c3de.Error) as caught:
                sim.warped_labels(progress=lambda fraction, text: False)
            self.assertEqual(caught.exception.kind, "cancelled")
            with self.assertRaises(ZeroDivisionError):
                sim.warped_image(progress=lambda fraction, text: 1 / 0)
            self.assertEqual(sim.state_hash, hash_before)
            self.assertEqual(sim.step(), 1)

    @needs_numpy
    def test_values_have_slope_and_intercept(self):
        data = (self.folder / "ct.mha").read_bytes()
        voxels = data[-2 * SIZE[0] * SIZE[1] * SIZE[2]:]
        # NIfTI-1 with scl_slope 2 and scl_inter -1024, voxels of 2 mm.
        header = bytearray(352)
        struct.pack_into("<i", header, 0, 348)
        struct.pack_into("<8h", header, 40, 3, *SIZE, 1, 1, 1, 1)
        struct.pack_into("<hh", header, 70, 4, 16)
        struct.pack_into("<8f", header, 76, 1, 2, 2, 2, 1, 1, 1, 1)
        struct.pack_into("<fff", header, 108, 352, 2, -1024)
        struct.pack_into("<hh", header, 252, 0, 1)
        struct.pack_into("<12f", header, 280, 2, 0, 0, -20, 0, 2, 0, -15, 0, 0, 2, -10)
        header[344:348] = b"n+1\0"
        (self.folder / "ct.nii").write_bytes(bytes(header) + voxels)
        self.scene.write_text((SCENE % "").replace("ct.mha", "ct.nii").replace(
            "volume = \"labels.mha\"\nlabel = 3", "volume = \"ct.nii\"\nthreshold = [-1000, 400]"))
        with c3de.open(self.scene) as sim:
            image = sim.warped_image()
        stored = numpy.frombuffer(voxels, "<i2").reshape(SIZE, order="F")
        self.assertEqual(image.scale, (2.0, -1024.0))
        self.assertTrue(numpy.array_equal(image.voxels, stored))
        self.assertEqual(image.array.dtype, numpy.int32)
        self.assertTrue(numpy.array_equal(image.array, 2 * stored.astype(int) - 1024))
        self.assertTrue(numpy.allclose(image.affine, [[2, 0, 0, -20], [0, 2, 0, -15], [0, 0, 2, -10], [0, 0, 0, 1]]))


if __name__ == "__main__":
    unittest.main(verbosity=2)
