# SPDX-License-Identifier: Apache-2.0
"""Pictures and windows of the Python package. Without numpy, OpenGL or a virtual screen their cases are skipped."""

import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import threading
import time
import unittest
from unittest import mock

import c3de

try:
    import numpy
except ImportError:
    numpy = None

SCENES = pathlib.Path(os.environ["C3DE_SCENES"])
CANTILEVER = SCENES / "cantilever.toml"
STIFFNESS = "body.beam.youngs_modulus"
SMALL = (160, 120)
TIMEOUT_S = 60
WITHOUT_DISPLAY = {"DISPLAY": "", "WAYLAND_DISPLAY": ""}


def has_graphics():
    with tempfile.TemporaryDirectory() as folder, c3de.open(CANTILEVER) as sim:
        try:
            sim.save_picture(pathlib.Path(folder, "a.png"), SMALL)
        except c3de.Error as error:
            return error.kind not in ("graphics", "unsupported")
        return True


needs_numpy = unittest.skipIf(numpy is None, "[C3DE-SKIPPED] numpy is not installed (Debian package python3-numpy)")
needs_graphics = unittest.skipUnless(has_graphics(), "[C3DE-SKIPPED] there is no OpenGL")


@needs_graphics
class Pictures(unittest.TestCase):
    def refused(self, call, kind, *texts):
        with self.assertRaises(c3de.Error) as caught:
            call()
        self.assertEqual(caught.exception.kind, kind, str(caught.exception))
        for text in texts:
            self.assertIn(text, str(caught.exception))

    @needs_numpy
    def test_a_picture_shows_the_present_state_without_a_display(self):
        with mock.patch.dict(os.environ, WITHOUT_DISPLAY), c3de.open(CANTILEVER) as sim:
            steps, rest = sim.state_hash, sim.picture(SMALL)
            self.assertEqual(sim.state_hash, steps)
            self.assertEqual((rest.shape, rest.dtype), ((120, 160, 3), numpy.uint8))
            self.assertGreater(len(numpy.unique(rest.reshape(-1, 3), axis=0)), 50)
            self.assertTrue(numpy.array_equal(sim.picture(SMALL), rest))
            sim.run()
            bent = sim.picture(SMALL)
            self.assertFalse(numpy.array_equal(bent, rest))
            bent[0, 0] = 0  # its memory is its own
            sim.close()

    @needs_numpy
    def test_it_is_the_picture_of_the_program(self):
        with tempfile.TemporaryDirectory() as folder, c3de.open(CANTILEVER, **{STIFFNESS: 8e5}) as sim:
            file = pathlib.Path(folder) / "a.ppm"
            subprocess.run([os.environ["C3DE_PROGRAM"], "run", CANTILEVER, "-q", "--set", "body.beam.material.youngs_modulus=8e5", "--screenshot",
                            file, "--size", "160x120", "--camera=-40,10", "--up", "z", "--set", "view.colour=von_mises"],
                           check=True)
            sim.run()
            drawn = sim.picture(SMALL, camera=(-40, 10), up="z", colour="von_mises")
            self.assertEqual(file.read_bytes(), b"P6\n160 120\n255\n" + drawn.tobytes())

    @needs_numpy
    def test_every_option_changes_the_picture(self):
        with c3de.open(CANTILEVER) as sim:
            sim.run()
            options = [{}, {"camera": (80, 5)}, {"up": "z"}, {"colour": "displacement"}, {"surface": "hidden"},
                       {"colour": "displacement", "colour_range": 100.0}]
            pictures = [sim.picture(SMALL, **one).tobytes() for one in options]
            self.assertEqual(len(set(pictures)), len(options))

    def test_values_that_are_refused(self):
        with c3de.open(CANTILEVER) as sim:
            cases = [({"size": (15, 100)}, "16 to 16384"), ({"size": (100, 16385)}, "16385"), ({"size": (1.5, 100)}, "1.5"),
                     ({"size": "100x100"}, "width"), ({"view": "top"}, "four-up"), ({"view": "axial"}, "no [image]"),
                     ({"view": "axial", "up": "z"}, "slice"), ({"camera": (0, 91)}, "-90 to 90"),
                     ({"camera": (float("nan"), 0)}, "nan"), ({"camera": ("left", 0)}, "-360 to 360"),
                     ({"camera": (None, 0)}, "None"), ({"up": "x"}, "x not in"), ({"colour": "red"}, "von_mises"),
                     ({"colour_range": -1.0}, "-1"), ({"surface": "thin"}, "transparent"), ({"overlay": "shift"}, "--overlay")]
            for options, text in cases:
                self.refused(lambda: sim.save_picture("never.png", **options), "argument", text)
            self.assertFalse(os.path.exists("never.png"))
            self.refused(lambda: sim.save_picture("/dev/null/a.png", SMALL), "input or output", "/dev/null/a.png")
        self.refused(lambda: sim.save_picture("never.png"), "closed")

    def test_reasons_without_program_and_opengl(self):
        with c3de.open(CANTILEVER) as sim, tempfile.TemporaryDirectory() as folder:
            with mock.patch.dict(os.environ, {"C3DE_PROGRAM": "/missing/c3de"}):
                self.refused(lambda: sim.save_picture("never.png"), "unsupported", "/missing/c3de", "C3DE_PROGRAM")
            failing = pathlib.Path(folder) / "c3de"
            failing.write_text("#!/bin/sh\necho 'c3de: error: no OpenGL 4.3' >&2\nexit 6\n")
            failing.chmod(0o755)
            with mock.patch.dict(os.environ, {"C3DE_PROGRAM": str(failing)}):
                self.refused(lambda: sim.save_picture("never.png"), "graphics", "the picture: no OpenGL 4.3")

    def test_the_library_loads_no_opengl_and_leaves_no_files(self):
        with tempfile.TemporaryDirectory() as folder, c3de.open(CANTILEVER) as sim:
            with mock.patch.object(tempfile, "tempdir", folder):
                sim.save_picture(pathlib.Path(folder) / "a.png", SMALL)
            self.assertEqual(os.listdir(folder), ["a.png"])
            if os.path.exists("/proc/self/maps"):
                maps = pathlib.Path("/proc/self/maps").read_text()
                self.assertNotIn("libGL", maps)
                self.assertNotIn("libEGL", maps)

    def test_a_scene_of_arrays_and_a_simulation_in_use(self):
        block = [[x, y, z] for x in (0, 0.2) for y in (0, 0.1) for z in (0, 0.1)]
        faces = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6],
                 [0, 6, 4], [1, 5, 7], [1, 7, 3]]
        with tempfile.TemporaryDirectory() as folder:
            with c3de.Scene("block").body("a", block, faces, sampling={"spacing": 0.03}).open() as sim:
                sim.step(2)
                sim.save_picture(pathlib.Path(folder) / "a.png", SMALL)
                kinds = []

                def progress(_fraction, _text):
                    try:
                        sim.save_picture(pathlib.Path(folder) / "b.png", SMALL)
                    except c3de.Error as error:
                        kinds.append(error.kind)
                    return len(kinds) == 0

                with self.assertRaises(c3de.Error):
                    sim.run(until=1e4, progress=progress)
                self.assertEqual(kinds, ["state"])
            self.assertEqual(os.listdir(folder), ["a.png"])


class Screen:
    """A virtual screen."""

    def __enter__(self):
        reading, writing = os.pipe()
        self.process = subprocess.Popen(["Xvfb", "-displayfd", str(writing), "-screen", "0", "1000x700x24", "-nolisten",
                                         "tcp"], pass_fds=[writing], stderr=subprocess.DEVNULL)
        os.close(writing)
        with os.fdopen(reading) as file:
            number = file.readline().strip()
        self.environment = mock.patch.dict(os.environ, {"DISPLAY": ":" + number, "WAYLAND_DISPLAY": "",
                                                        "C3DE_HOME": tempfile.mkdtemp()})
        self.environment.start()
        return self

    def __exit__(self, *_exception):
        shutil.rmtree(os.environ["C3DE_HOME"], ignore_errors=True)
        self.environment.stop()
        self.process.terminate()
        self.process.wait()


class Exit(unittest.TestCase):
    @unittest.skipIf(os.name == "nt", "[C3DE-SKIPPED] the program is a script of the shell")
    def test_the_folder_of_a_window_is_removed_where_its_thread_is_stopped(self):
        """A window of a program without graphics, in a process that ends while the window is open."""
        with tempfile.TemporaryDirectory() as folder:
            program = pathlib.Path(folder) / "program"
            program.write_text("#!/bin/sh\nexec sleep 600\n")
            program.chmod(0o755)
            temporary = pathlib.Path(folder) / "temporary"
            temporary.mkdir()
            script = ("import os, sys, tempfile, c3de\n"
                      "from c3de._pictures import Window\n"
                      "Window._follow = lambda *_: None  # a thread that the end of the interpreter has stopped\n"
                      "window = c3de.open(sys.argv[1]).show(wait=False)\n"
                      "print(*os.listdir(tempfile.gettempdir()), window.is_open)\n")
            environment = {**os.environ, "DISPLAY": ":9999", "TMPDIR": str(temporary), "C3DE_PROGRAM": str(program)}
            ended = subprocess.run([sys.executable, "-B", "-c", script, str(CANTILEVER)], env=environment, text=True,
                                   capture_output=True, timeout=TIMEOUT_S)
            self.assertEqual((ended.returncode, ended.stderr), (0, ""))
            self.assertRegex(ended.stdout, r"^c3de-\w+ True$")
            self.assertEqual(os.listdir(temporary), [])


def waited_for(condition):
    end = time.monotonic() + TIMEOUT_S
    while time.monotonic() < end:
        if condition():
            return True
        time.sleep(0.05)
    return False


def state_of(file):
    try:
        return json.loads(file.read_text())
    except (OSError, ValueError):
        return {}


@needs_graphics
@unittest.skipUnless(shutil.which("Xvfb") and shutil.which("xdotool"),
                     "[C3DE-SKIPPED] Xvfb or xdotool is not installed (Debian packages xvfb, xdotool)")
class Windows(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder, True)
        self.state = self.folder / "state.json"
        self.arguments = ("--automation-state", str(self.state), "--size", "900x600")

    def steps(self):
        return state_of(self.state).get("transport", {}).get("steps", -1)

    def quits(self, thread):
        """A busy machine may miss a key that is pressed for a short time."""
        subprocess.run(["xdotool", "keydown", "ctrl", "keydown", "q"], check=True)
        thread.join(0.5)
        subprocess.run(["xdotool", "keyup", "q", "keyup", "ctrl"], check=True)
        thread.join(0.5)
        return not thread.is_alive()

    def test_show_returns_when_the_user_quits(self):
        with Screen(), c3de.open(CANTILEVER) as sim:
            sim.run()
            before = sim.state_hash
            errors = []

            def show():
                try:
                    errors.append(sim.show(arguments=self.arguments))
                except c3de.Error as error:
                    errors.append(error)

            thread = threading.Thread(target=show)
            thread.start()
            self.assertTrue(waited_for(lambda: self.steps() == sim.steps or errors), state_of(self.state))
            self.assertEqual(errors, [])
            title = state_of(self.state)["title"]
            self.assertTrue(title.startswith("Cantilever") and "*" not in title, title)
            self.assertTrue(waited_for(lambda: self.quits(thread)), state_of(self.state))
            self.assertEqual(errors, [None])
            self.assertEqual(sim.state_hash, before)
            recent = pathlib.Path(os.environ["C3DE_HOME"], "recent", "recent.json")
            self.assertNotIn("simulation.c3de", recent.read_text() if recent.exists() else "")

    def test_windows_beside_a_running_simulation(self):
        with Screen(), c3de.open(SCENES / "first_light.toml") as sim, mock.patch.object(tempfile, "tempdir", str(self.folder)):
            sim.step(2)
            with sim.show(wait=False, play=True, arguments=self.arguments) as window:
                self.assertTrue(waited_for(lambda: self.steps() > 3), state_of(self.state))
                self.assertTrue(window.is_open)
                self.assertEqual(sim.step(2), 2)
            self.assertFalse(window.is_open)
            window.wait()
            window.close()
            self.assertEqual([one for one in os.listdir(self.folder) if one.startswith("c3de-")], [])

    def test_reasons_without_a_display(self):
        with c3de.open(CANTILEVER) as sim:
            with mock.patch.dict(os.environ, WITHOUT_DISPLAY), self.assertRaises(c3de.Error) as caught:
                sim.show()
            self.assertEqual(caught.exception.kind, "graphics")
            self.assertIn("DISPLAY", str(caught.exception))
            with mock.patch.dict(os.environ, {"DISPLAY": ":9999"}), self.assertRaises(c3de.Error) as caught:
                sim.show()
            self.assertEqual(caught.exception.kind, "graphics", str(caught.exception))
            with Screen(), self.assertRaises(c3de.Error) as caught:
                sim.show(arguments=["--no-such-option"])
            self.assertEqual(caught.exception.kind, "argument")
            self.assertIn("--no-such-option", str(caught.exception))


if __name__ == "__main__":
    unittest.main(verbosity=2)
