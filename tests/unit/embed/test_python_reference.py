# SPDX-License-Identifier: Apache-2.0
"""The reference (docs/reference) is built without a warning, is complete and needs no network; the texts and hints of
the Python package are complete. Without Doxygen, Sphinx or mypy the cases that need them are skipped."""

import inspect
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import c3de

SOURCE = pathlib.Path(os.environ["C3DE_DOCS"]).parents[1]
PACKAGE = pathlib.Path(c3de.__file__).parent
DOXYGEN, PYTHON = os.environ.get("C3DE_DOXYGEN", ""), os.environ.get("C3DE_PYTHON_WITH_SPHINX", "")


def runs(*command):
    try:
        return subprocess.run(command, capture_output=True).returncode == 0
    except OSError:
        return False


def has_mypy():
    return runs(sys.executable, "-m", "mypy", "--version")


@unittest.skipUnless(runs(DOXYGEN, "--version") and runs(PYTHON, "-c", "import sphinx, myst_parser"),
                     "[C3DE-SKIPPED] Doxygen, Sphinx or MyST is not installed (Debian packages doxygen, python3-sphinx, "
                     "python3-myst-parser)")
class Reference(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp())
        cls.site = cls.folder / "site"
        cls.built = subprocess.run(
            [os.environ["C3DE_CMAKE"], "-DSOURCE=%s" % SOURCE, "-DPACKAGE=%s" % PACKAGE.parent, "-DOUTPUT=%s" % cls.site,
             "-DPYTHON=" + PYTHON, "-DDOXYGEN=" + DOXYGEN, "-DVERSION=1.2.3", "-DSTRICT=ON", "-P",
             SOURCE / "cmake/BuildReference.cmake"], text=True, capture_output=True, timeout=300)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    def page(self, name):
        return (self.site / name).read_text()

    def test_it_is_built_without_warnings(self):
        self.assertEqual((self.built.returncode, self.built.stderr), (0, ""), self.built.stdout)
        self.assertIn("1.2.3", self.page("reference/index.html"))
        self.assertEqual(sorted(one.name for one in self.folder.iterdir()), ["site"])

    def test_it_has_every_page_and_every_name(self):
        for page in [*SOURCE.glob("docs/*/*.md"), *SOURCE.glob("docs/user/tutorials/*.md")]:
            self.assertTrue((self.site / page.relative_to(SOURCE / "docs").with_suffix(".html")).exists(), page)
        parameters = self.page("reference/parameters.html")
        for key in "body.NAME.material.youngs_modulus", "solver.damping", "world.gravity":
            self.assertIn(key, parameters)
        self.assertIn('"title": "Report of c3de run"', self.page("report.schema.json"))
        python = self.page("reference/python.html")
        for name in c3de.__all__:
            self.assertIn('id="c3de.%s"' % name, python)
        for name in "picture", "save_picture", "show", "run", "step", "report":
            self.assertIn('id="c3de.Simulation.%s"' % name, python)
        header = self.page("c/embed_8h.html")
        for name in re.findall(r"C3DE_EMBED_API .*?(c3de_embed_\w+)\(", (SOURCE / "framework/embed/include/c3de/embed.h").read_text()):
            self.assertIn(name + "()", header)
        self.assertIn("must not step, change or close it", header)  # a comment before a declaration
        self.assertIn("valid until the simulation is closed", self.page("c/structc3de__embed__body.html"))  # one after it
        self.assertTrue((self.site / "c/simulator_8h.html").exists())

    def test_it_is_searched_and_read_without_a_network(self):
        self.assertIn("timoshenko", self.page("searchindex.js"))
        self.assertTrue(list(self.site.glob("c/search/*.js")))
        for file in self.site.rglob("*"):
            self.assertFalse(file.is_symlink(), file)
            if file.suffix == ".html":
                for tag in re.findall(r"<(?:script|link|img|iframe)\b[^>]*>", file.read_text(errors="replace")):
                    self.assertNotRegex(tag, r"(?:src|href)=.(?:https?:)?//", file)
            elif file.suffix == ".css":
                self.assertNotRegex(file.read_text(errors="replace"), r"(?:@import|url\()[^;)]*//", file)


class Texts(unittest.TestCase):
    def public(self):
        for name in c3de.__all__:
            item = getattr(c3de, name)
            yield name, item
            if inspect.isclass(item):
                fields = item._fields if issubclass(item, tuple) else ()
                for member, value in inspect.getmembers(item):
                    own = callable(value) or isinstance(value, property)
                    inherited = hasattr(tuple, member) or hasattr(Exception, member)
                    if own and not member.startswith("_") and member not in fields and not inherited:
                        yield "%s.%s" % (name, member), value

    def test_every_public_item_has_a_text(self):
        for name, item in self.public():
            self.assertTrue(inspect.getdoc(item), name)
            for field in getattr(item, "_fields", ()) if inspect.isclass(item) and issubclass(item, tuple) else ():
                self.assertIn("- %s: " % field, item.__doc__)
        for name in "open", "run", "step", "picture", "field", "hold":
            item = getattr(c3de, name, None) or getattr(c3de.Simulation, name, None) or getattr(c3de.PointSet, name, None) \
                or getattr(c3de.Body, name)
            self.assertIn("Raises Error", inspect.getdoc(item), name)
        printed = subprocess.run([sys.executable, "-c", "import c3de; help(c3de)"], text=True, capture_output=True,
                                 env={**os.environ, "PAGER": "cat", "MANPAGER": "cat"})
        self.assertEqual(printed.returncode, 0, printed.stderr)
        for text in "import c3de", "class Simulation", "picture(self", "Raises Error":
            self.assertIn(text, printed.stdout)

    @unittest.skipUnless(has_mypy(), "[C3DE-SKIPPED] mypy is not installed (Debian package mypy)")
    def test_the_hints_are_right(self):
        self.assertTrue((PACKAGE / "py.typed").exists())
        with tempfile.TemporaryDirectory() as folder:
            user = pathlib.Path(folder) / "user.py"
            user.write_text("import c3de\nsim = c3de.open('a.toml')\nn: int = sim.step(3)\nwindow = sim.show(wait=False)\n"
                            "name: str = sim.bodies[0].name\nsim.run(until='later')\n")
            checked = subprocess.run([sys.executable, "-m", "mypy", "--cache-dir", folder, "--ignore-missing-imports",
                                      "--disallow-untyped-defs", str(PACKAGE), str(user)], text=True, capture_output=True,
                                     env={**os.environ, "MYPYPATH": str(PACKAGE.parent)})
        problems = [line for line in checked.stdout.splitlines() if ": error:" in line]
        self.assertEqual(len(problems), 1, checked.stdout + checked.stderr)
        self.assertIn("user.py:6", problems[0])


if __name__ == "__main__":
    unittest.main(verbosity=2)
