# SPDX-License-Identifier: Apache-2.0
"""The programs of docs/user/embed.md, docs/user/python.md and its tutorial, as they are, with an installed library."""

import os
import pathlib
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest

DOCS, SCENES, BUILD = (pathlib.Path(os.environ[name]) for name in ("C3DE_DOCS", "C3DE_SCENES", "C3DE_BUILD"))


def blocks(page, language):
    return re.findall(r"^```%s\n(.*?)^```" % language, (DOCS / page).read_text(), re.M | re.S)


def write_scan(folder):
    """scan.toml: a block of label 1 in an image of 16 x 12 x 10 voxels of 2 mm."""
    size = (16, 12, 10)
    inside = [3 <= i < 12 and 3 <= j < 9 and 2 <= k < 8
              for k in range(size[2]) for j in range(size[1]) for i in range(size[0])]
    for name, kind, code, values in (("scan.mha", "MET_SHORT", "h", [50 if one else -900 for one in inside]),
                                     ("labels.mha", "MET_UCHAR", "B", [int(one) for one in inside])):
        header = ("ObjectType = Image\nNDims = 3\nBinaryData = True\nElementSpacing = 2 2 2\nDimSize = %d %d %d\n"
                  "ElementType = %s\nElementDataFile = LOCAL\n" % (*size, kind))
        (folder / name).write_bytes(header.encode() + struct.pack("<%d%s" % (len(values), code), *values))
    (folder / "scan.toml").write_text(
        "format = 1\n[world]\ngravity = [0, 0, -9.81]\n[image]\nfile = \"scan.mha\"\nlabels = \"labels.mha\"\n"
        "[[body]]\nname = \"block\"\nvolume = \"labels.mha\"\nlabel = 1\nsampling = { count = 100 }\n")


class Documents(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp())
        cls.prefix = cls.folder / "prefix"
        subprocess.run([os.environ["C3DE_CMAKE"], "--install", str(BUILD), "--component", "embed", "--prefix",
                        str(cls.prefix)], check=True, capture_output=True)
        (cls.folder / "meshes").symlink_to(SCENES.parent / "meshes")
        (cls.folder / "work").mkdir()
        for scene in SCENES.glob("*.toml"):
            shutil.copy(scene, cls.folder / "work")
        write_scan(cls.folder / "work")

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    def run_in_folder(self, *command, **environment):
        everything = {**os.environ, "C3DE_PLUGIN_PATH": str(BUILD / "lib/c3de/plugins"), **environment}
        return subprocess.run([str(word) for word in command], cwd=self.folder / "work", env=everything, text=True,
                              capture_output=True, timeout=240)

    def compiled(self, *flags):
        programs = blocks("embed.md", "c")
        self.assertEqual(len(programs), 1)
        source = self.folder / "program.c"
        source.write_text(programs[0])
        program = self.folder / "program"
        built = self.run_in_folder(os.environ["C3DE_CC"], "-std=c11", "-Wall", "-Wextra", "-Wpedantic", "-Werror", source,
                                   "-o", program, *flags)
        self.assertEqual(built.returncode, 0, built.stderr)
        return program

    def test_the_program_in_c(self):
        program = self.compiled("-I%s" % (self.prefix / "include"), "-L%s" % (self.prefix / "lib"), "-lc3de")
        path = {"LD_LIBRARY_PATH": str(self.prefix / "lib")}
        ran = self.run_in_folder(program, "cantilever.toml", **path)
        self.assertEqual((ran.returncode, ran.stderr), (0, ""))
        found = re.fullmatch(r"(\d+) points, lowest (-0\.\d+) m\n", ran.stdout)
        self.assertIsNotNone(found, ran.stdout)
        self.assertLess(float(found.group(2)), -0.02)
        refused = self.run_in_folder(program, "missing.toml", **path)
        self.assertEqual(refused.returncode, 1)
        self.assertIn("missing.toml", refused.stderr)

    def test_pkg_config_has_all_flags(self):
        if shutil.which("pkg-config") is None:
            self.skipTest("pkg-config is not installed")
        file = next(self.prefix.rglob("c3de-embed.pc"))
        flags = subprocess.run(["pkg-config", "--cflags", "--libs", "c3de-embed"], text=True, check=True,
                               capture_output=True, env={**os.environ, "PKG_CONFIG_PATH": str(file.parent)}).stdout
        self.compiled(*flags.split())

    def test_the_cmake_package_links_a_c_program(self):
        source = self.folder / "cmake"
        source.mkdir()
        (source / "my_program.c").write_text(blocks("embed.md", "c")[0])
        (source / "CMakeLists.txt").write_text(
            "cmake_minimum_required(VERSION 3.25)\nproject(my_program LANGUAGES C)\nadd_executable(my_program my_program.c)\n" +
            blocks("embed.md", "cmake")[0])
        for step in (["-S", source, "-B", source / "build", "-DCMAKE_PREFIX_PATH=%s" % self.prefix,
                      "-DCMAKE_C_COMPILER=" + os.environ["C3DE_CC"]], ["--build", source / "build"]):
            done = self.run_in_folder(os.environ["C3DE_CMAKE"], *step)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        ran = self.run_in_folder(source / "build" / "my_program", "cantilever.toml")
        self.assertEqual(ran.returncode, 0, ran.stderr)

    def test_the_programs_in_python(self):
        try:
            import numpy  # noqa: F401
        except ImportError:
            self.skipTest("[C3DE-SKIPPED] numpy is not installed (Debian package python3-numpy)")
        programs = blocks("python.md", "python")
        self.assertGreater(len(programs), 5)
        drawn = self.run_in_folder(os.environ["C3DE_PROGRAM"], "run", "cantilever.toml", "-q", "--screenshot", "a.png")
        if drawn.returncode == 6:  # no OpenGL, or a build without a window
            programs = [one for one in programs if "picture(" not in one]
        program = self.folder / "program.py"
        program.write_text("\n".join(programs))
        ran = self.run_in_folder(sys.executable, program, PYTHONPATH=str(self.prefix / "lib/python3/dist-packages"))
        self.assertEqual((ran.returncode, ran.stderr), (0, ""))
        self.assertIn("lowest -0.", ran.stdout)
        self.assertEqual(ran.stdout.count("body.beam.youngs_modulus"), 2)
        self.assertIn("(16, 12, 10) int16", ran.stdout)
        self.assertTrue((self.folder / "work" / "deformed.nii.gz").exists())

    def test_the_tutorial_in_python(self):
        try:
            import numpy  # noqa: F401
        except ImportError:
            self.skipTest("[C3DE-SKIPPED] numpy is not installed (Debian package python3-numpy)")
        programs = blocks("tutorials/python.md", "python")
        self.assertEqual(len(programs), 4)
        program = self.folder / "tutorial.py"
        program.write_text("\n".join(programs))
        ran = self.run_in_folder(sys.executable, program)
        self.assertEqual((ran.returncode, ran.stderr), (0, ""))
        points, mass, mean, largest, stiffer = (float(one) for one in re.findall(
            r"(\d+) points, ([\d.]+) kg\nmean ([\d.]+) mm, largest ([\d.]+) mm\n\(112, 80, 56\) int16\nstiffer: mean ([\d.]+) mm\n", ran.stdout)[0])
        self.assertAlmostEqual(points, 2000, delta=100)
        self.assertAlmostEqual(mass, 1.1, delta=0.1)
        self.assertTrue(stiffer < 0.9 * mean < largest, ran.stdout)
        self.assertTrue((self.folder / "work" / "standing.nii.gz").exists())


if __name__ == "__main__":
    unittest.main(verbosity=2)
