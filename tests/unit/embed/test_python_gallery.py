# SPDX-License-Identifier: Apache-2.0
"""The scripts of docs/gallery, as they are. Without the packages and the scan that they need they are skipped."""

import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

DOCS = pathlib.Path(os.environ["C3DE_DOCS"])
SCRIPTS = DOCS.parent / "gallery"
SCAN = pathlib.Path("/usr/share/mricron/templates/ch2.nii.gz")

try:
    import matplotlib.image
    import numpy
except ImportError:
    matplotlib = None
try:
    import nibabel
except ImportError:
    nibabel = None

needs_nibabel = unittest.skipIf(nibabel is None, "[C3DE-SKIPPED] nibabel is not installed (Debian package python3-nibabel)")


@unittest.skipIf(matplotlib is None, "[C3DE-SKIPPED] matplotlib is not installed (Debian package python3-matplotlib)")
class Gallery(unittest.TestCase):
    def ran(self, name):
        """The numbers of each line that the script prints."""
        with tempfile.TemporaryDirectory() as folder:
            environment = {**os.environ, "DISPLAY": "", "WAYLAND_DISPLAY": "", "MPLCONFIGDIR": folder}
            ended = subprocess.run([sys.executable, "-B", SCRIPTS / (name + ".py"), pathlib.Path(folder, "out")],
                                   env=environment, text=True, capture_output=True, timeout=240)
            if ended.returncode != 0 and "OpenGL" in ended.stderr:
                self.skipTest("[C3DE-SKIPPED] there is no OpenGL")
            self.assertEqual((ended.returncode, ended.stderr), (0, ""))
            picture = matplotlib.image.imread(str(pathlib.Path(folder, "out", name + ".png")))[..., :3]
        self.assertGreater(min(picture.shape[:2]), 200)
        self.assertGreater(len(numpy.unique(picture.reshape(-1, 3), axis=0)), 50)
        return [[float(one) for one in re.findall(r"-?\d+\.?\d*", line)] for line in ended.stdout.splitlines()]

    def test_every_script_is_short_and_on_the_page(self):
        page = (DOCS / "gallery.md").read_text()
        for script in SCRIPTS.glob("*.py"):
            self.assertLessEqual(len(script.read_text().splitlines()), 60, script)
            self.assertIn(script.name, page)
            self.assertTrue((DOCS / "images" / ("gallery_%s.png" % script.stem)).exists(), script)
            self.assertIn("test_" + script.stem, dir(self), script)

    def test_beam_theory(self):
        (tip, theory, difference), = self.ran("beam_theory")
        self.assertLess(theory, -1.0)
        self.assertAlmostEqual(difference, -0.7, delta=0.05)  # as on the page
        self.assertAlmostEqual(100 * (tip / theory - 1), difference, delta=0.02)

    def test_stiffness_sweep(self):
        rows = self.ran("stiffness_sweep")
        self.assertEqual(len(rows), 7)
        for soft, stiff in zip(rows, rows[1:]):
            self.assertGreater(soft[1], stiff[1])
        self.assertTrue(all(0.0 < error < 0.02 * sag for _, sag, error in rows), rows)

    def test_speed_accuracy(self):
        rows = self.ran("speed_accuracy")
        self.assertEqual([count for count, _, _ in rows], sorted(count for count, _, _ in rows))
        self.assertLess(rows[-1][2], 0.6 * rows[0][2])
        self.assertLess(max(error for _, _, error in rows), 0.5)  # as on the page

    def test_living_scan(self):
        (moved, left, back, up), = self.ran("living_scan")
        self.assertAlmostEqual(moved, 12.5, delta=0.3)  # as on the page
        self.assertAlmostEqual((left ** 2 + back ** 2 + up ** 2) ** 0.5, moved, delta=0.2)
        self.assertTrue(back < -5.0 > up)

    @needs_nibabel
    def test_pulled_labels(self):
        (moved, force), (largest,) = self.ran("pulled_labels")
        self.assertGreater(moved, 10.0)
        self.assertGreater(force, 0.1)
        self.assertGreaterEqual(largest, moved)

    @needs_nibabel
    @unittest.skipUnless(SCAN.exists(), "[C3DE-SKIPPED] there is no scan of a head (Debian package mricron-data)")
    def test_brain_shift(self):
        (mean, largest), = self.ran("brain_shift")
        self.assertTrue(2.0 < mean < 10.0 < largest < 40.0, (mean, largest))


if __name__ == "__main__":
    unittest.main(verbosity=2)
