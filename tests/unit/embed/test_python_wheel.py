# SPDX-License-Identifier: Apache-2.0
"""The wheel of the package is complete, and its package simulates with the library that C3DE_LIBRARY names."""

import base64
import hashlib
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest
import zipfile

SOURCE = pathlib.Path(os.environ["C3DE_DOCS"]).parents[1]
BUILD = pathlib.Path(os.environ["C3DE_BUILD"])
PACKAGE = BUILD / "lib/python3/dist-packages/c3de"


def make_wheel(package, folder):
    return subprocess.run([sys.executable, str(SOURCE / "tools/make_wheel.py"), str(package), "0.1.0", folder],
                          capture_output=True, text=True)


class Wheel(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def wheel(self):
        made = make_wheel(PACKAGE, self.folder.name)
        self.assertEqual(made.returncode, 0, made.stderr)
        return pathlib.Path(made.stdout.strip())

    def test_its_record_lists_every_file(self):
        with zipfile.ZipFile(self.wheel()) as archive:
            record = archive.read("c3de-0.1.0.dist-info/RECORD").decode().splitlines()
            listed = {line.split(",")[0]: line.split(",")[1] for line in record}
            self.assertEqual(set(listed), set(archive.namelist()))
            for name, digest in listed.items():
                if name.endswith("RECORD"):
                    continue
                content = hashlib.sha256(archive.read(name)).digest()
                self.assertEqual(digest, "sha256=" + base64.urlsafe_b64encode(content).rstrip(b"=").decode())
            for file in PACKAGE.glob("*.py"):
                self.assertIn("c3de/" + file.name, listed)

    def test_it_simulates_after_installation(self):
        target = pathlib.Path(self.folder.name) / "site"
        wheel = self.wheel()
        pip = [sys.executable, "-m", "pip", "install", "-q", "--no-index", "--no-deps", "--target", str(target), str(wheel)]
        if subprocess.run([sys.executable, "-m", "pip", "--version"], capture_output=True).returncode == 0:
            installed = subprocess.run(pip, capture_output=True, text=True)
            self.assertEqual(installed.returncode, 0, installed.stderr)
        else:
            zipfile.ZipFile(wheel).extractall(target)
        scene = os.path.join(os.environ["C3DE_SCENES"], "cantilever.toml")
        program = f"import c3de; sim = c3de.open({scene!r}); sim.step(2); print(c3de.__file__, sim.steps)"
        # Of the library alone, without the folder of the build.
        environment = dict(os.environ, PYTHONPATH=str(target), C3DE_LIBRARY=str(BUILD / "lib/libc3de.so.0"))
        done = subprocess.run([sys.executable, "-B", "-c", program], capture_output=True, text=True, env=environment)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(done.stdout.split(), [str(target / "c3de" / "__init__.py"), "2"])

    def test_what_is_no_package_is_refused(self):
        made = make_wheel(self.folder.name, self.folder.name)
        self.assertNotEqual(made.returncode, 0)
        self.assertIn("has no __init__.py", made.stderr)


if __name__ == "__main__":
    unittest.main()
