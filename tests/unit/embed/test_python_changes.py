# SPDX-License-Identifier: Apache-2.0
"""Supports and loads that Python sets, recordings and their replay."""

import json
import os
import pathlib
import subprocess
import tempfile
import threading
import unittest

import c3de

try:
    import numpy
except ImportError:
    numpy = None

PROGRAM = os.environ["C3DE_PROGRAM"]
SCENES = pathlib.Path(os.environ["C3DE_SCENES"])
CANTILEVER, FALLING = SCENES / "cantilever.toml", SCENES / "first_light.toml"
needs_numpy = unittest.skipIf(numpy is None, "[C3DE-SKIPPED] numpy is not installed (Debian package python3-numpy)")
BOX = [[x, y, z] for x in (0, 0.2) for y in (0, 0.1) for z in (0, 0.1)]
BOX_FACES = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4],
             [1, 5, 7], [1, 7, 3]]
LEFT = {"min": [-1e-6, -1, -1], "max": [1e-6, 1, 1]}
RIGHT_BOX = ([0.2, -1, -1], [0.2, 1, 1])
TIP = [0.2, 0.05, 0.05]


def block(integrator, **load):
    scene = c3de.Scene("block", world={"gravity": [0, 0, 0]}, solver={"integrator": integrator})
    scene.body("block", BOX, BOX_FACES, material={"law": "neo_hookean", "youngs_modulus": 1e5, "density": 1000.0},
               sampling={"spacing": 0.025})
    scene.fix("block", {"box": LEFT})
    if load:
        scene.load("block", {"box": {"min": RIGHT_BOX[0], "max": RIGHT_BOX[1]}}, **load)
    return scene.probe("tip", "block", TIP)


def tip(sim):
    return sim.report()["probes"][0]["position_m"]


def run(*words):
    return subprocess.run([PROGRAM, *map(str, words)], capture_output=True, text=True)


class Conditions(unittest.TestCase):
    def folder(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        return pathlib.Path(folder.name)

    def bent(self, scene, add):
        with scene.open(threads=1) as sim:
            if add:
                add(sim.body("block"))
            sim.run(None if sim.status.quasistatic else 0.05)
            return [now - before for now, before in zip(tip(sim), TIP)]

    def test_a_force_and_a_pressure_bend_as_those_of_a_scene(self):
        cases = [({"force": [0, 0, -4.0]}, lambda body: body.add_force([0, 0, -4.0], box=RIGHT_BOX)),
                 ({"pressure": 2000.0}, lambda body: body.add_pressure(2000.0, box=RIGHT_BOX))]
        for integrator in "quasistatic", "explicit":
            for load, add in cases:
                of_scene = self.bent(block(integrator, **load), None)
                own = self.bent(block(integrator), add)
                largest = max(map(abs, of_scene))
                self.assertGreater(largest, 1e-3)
                # The scene and the tool sample the loaded face differently.
                for a, b in zip(of_scene, own):
                    self.assertAlmostEqual(a, b, delta=0.01 * largest)

    def test_a_force_of_an_implicit_simulation_has_the_state_hash_of_the_scene_that_states_it(self):
        hashes = []
        for load, add in ({"force": [0, 0, -4.0]}, False), ({}, True):
            with block("implicit", **load).open(threads=1) as sim:
                if add:
                    sim.body("block").add_force([0, 0, -4.0], box=RIGHT_BOX)
                sim.step(20)
                hashes.append(sim.state_hash)
        self.assertEqual(hashes[0], hashes[1])

    def test_vertices_and_a_box_around_them_are_the_same_part(self):
        hashes = []
        for part in {"box": RIGHT_BOX}, {"vertices": [4, 5, 6, 7]}:
            with block("explicit").open(threads=1) as sim:
                force = sim.body("block").add_force([0, 1, 0], **part)
                self.assertAlmostEqual(force.area, 0.01, places=9)
                self.assertEqual(force.warning, "")
                sim.step(20)
                self.assertAlmostEqual(force.force[1], 1.0, places=6)
                hashes.append(sim.state_hash)
        self.assertEqual(hashes[0], hashes[1])

    def test_a_box_cuts_the_triangles_of_the_surface(self):
        with block("explicit").open(threads=1) as sim:
            part = sim.body("block").add_pressure(10.0, box=([0.05, 0.02, 0.09], [0.15, 0.07, 0.2]))
            self.assertAlmostEqual(part.area, 0.1 * 0.05, places=12)

    def test_supports_hold_and_move_and_react(self):
        with block("explicit").open(threads=1) as sim:
            body = sim.body("block")
            moved = body.add_displacement([0.01, 0, 0], box=RIGHT_BOX, ramp=0.05)
            sim.run(0.2)
            self.assertAlmostEqual(tip(sim)[0], 0.21, delta=2e-4)
            self.assertGreater(moved.force[0], 0.0)
            moved.change([0.0, 0.0, 0.0], ramp=0.05)
            sim.run(0.4)
            self.assertAlmostEqual(tip(sim)[0], 0.2, delta=2e-4)
            moved.remove()
            with self.assertRaises(c3de.Error) as caught:
                moved.force
            self.assertEqual(caught.exception.kind, "closed")
            held = body.add_support(box=RIGHT_BOX)
            pressed = body.add_pressure(1000.0, box=([0.05, 0, 0.1], [0.15, 0.1, 0.1]))
            # A side through a face of the box is in it, whatever the round-off of its corners.
            body.add_pressure(10.0, box=([0.05, 0, 0.1 + 1e-14], [0.15, 0.1, 0.2])).remove()
            sim.run(0.5)
            self.assertAlmostEqual(tip(sim)[0], 0.2, delta=5e-4)
            self.assertGreater(held.force[2], 0.0)
            self.assertLess(pressed.force[2], 0.0)

    def test_sessions_recordings_and_resets_have_them(self):
        folder = self.folder()
        scene = block("explicit")
        with scene.open(threads=1) as sim:
            with sim.record(folder / "a.c3dr", hash_every=5):
                sim.step(10)
                force = sim.body("block").add_force([0, 0, -4.0], box=RIGHT_BOX, ramp=0.01)
                sim.step(10)
                sim.save_session(folder / "a.c3de")
                saved, force_then = sim.state_hash, force.force
                sim.step(10)
                later = sim.state_hash
                sim.reset()
                sim.step(3)
                after_reset = sim.state_hash
            self.assertLess(force_then[2], 0.0)
            with scene.open(threads=1) as plain:
                plain.step(3)
                self.assertNotEqual(plain.state_hash, after_reset)
            with c3de.open(folder / "a.c3de", threads=1) as continued:
                self.assertEqual(continued.state_hash, saved)
                continued.step(10)
                self.assertEqual(continued.state_hash, later)
            ran = run("run", folder / "a.c3de", "--steps", "30", "-q", "--threads", "1", "--report", folder / "r.json")
            self.assertEqual(ran.returncode, 0, ran.stderr)
            report = json.loads((folder / "r.json").read_text())
            self.assertEqual(report["state_hash"], later)
            replayed = run("replay", folder / "a.c3dr", "--check", "-q", "--report", folder / "p.json")
            self.assertEqual(replayed.returncode, 0, replayed.stderr)
            self.assertEqual(json.loads((folder / "p.json").read_text())["state_hash"], after_reset)
            with c3de.replay(folder / "a.c3dr") as again:
                self.assertEqual(again.state_hash, after_reset)

    def test_errors_leave_everything_as_it_was(self):
        with block("explicit").open(threads=1) as sim:
            body = sim.body("block")
            before = sim.state_hash
            cases = [(lambda: body.add_force([0, 0, 1]), "missing"),
                     (lambda: body.add_force([0, 0, 1], box=RIGHT_BOX, vertices=[0]), "both"),
                     (lambda: body.add_force([0, 0, 1], box=([5, 5, 5], [6, 6, 6])), "no surface"),
                     (lambda: body.add_force([0, 0, 1], box=([1, 0, 0], [0, 1, 1])), "least"),
                     (lambda: body.add_force([0, 0, 1], box=([0, 0, 0],)), "2"),
                     (lambda: body.add_force([0, 0, 1], vertices=[4]), "one triangle"),
                     (lambda: body.add_force([0, 0, 1], vertices=[4, 99]), "below 8"),
                     (lambda: body.add_force([0, 0, 1], vertices=[-1]), "negative"),
                     (lambda: body.add_force([0, 0, float("nan")], box=RIGHT_BOX), "finite"),
                     (lambda: body.add_force([0, 0, 1e9], box=RIGHT_BOX), "accepted"),
                     (lambda: body.add_pressure(1e12, box=RIGHT_BOX), "kPa"),
                     (lambda: body.add_displacement([5, 0, 0], box=RIGHT_BOX), "mm"),
                     (lambda: body.add_support(box=RIGHT_BOX, ramp=-1.0), "accepted")]
            for call, text in cases:
                with self.assertRaises(c3de.Error) as caught:
                    call()
                self.assertEqual(caught.exception.kind, "argument", str(caught.exception))
                self.assertIn(text, str(caught.exception))
            body.add_displacement([0.001, 0, 0], box=RIGHT_BOX, name="drawer").remove()
            force = body.add_force([0, 0, 1], box=RIGHT_BOX)
            with self.assertRaises(c3de.Error):
                force.change([0, 0, 1e9])
            force.change([0, 0, 2])
            force.remove()
            with self.assertRaises(c3de.Error):
                force.remove()
            self.assertEqual(sim.state_hash, before)

    @needs_numpy
    def test_vertices_are_an_array_of_numpy(self):
        with block("explicit").open(threads=1) as sim:
            surface = sim.body("block").surface
            chosen = numpy.flatnonzero(surface.vertices[:, 0] > 0.19)
            self.assertAlmostEqual(sim.body("block").add_force([0, 0, 1], vertices=chosen).area, 0.01, places=9)

    def test_another_simulator_refuses_with_its_name(self):
        plugin = pathlib.Path(os.environ["C3DE_BUILD"]) / "plugins" / "mass_spring.so"
        found = list(pathlib.Path(os.environ["C3DE_BUILD"]).rglob("mass_spring.so"))
        if not found:
            self.skipTest("[C3DE-SKIPPED] %s is not built" % plugin.name)
        with c3de.open(SCENES / "springs.toml", plugins=[found[0]]) as sim, self.assertRaises(c3de.Error) as caught:
            sim.bodies[0].add_force([0, 0, 1], box=([-9, -9, -9], [9, 9, 9]))
        self.assertEqual(caught.exception.kind, "unsupported")
        self.assertIn("[[load]]", str(caught.exception))


class Recordings(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def test_everything_that_changes_is_repeated(self):
        file = self.folder / "a.c3dr"
        with c3de.open(FALLING, threads=1) as sim:
            recording = sim.record(file, hash_every=2)
            sim.step(4)
            sim["world.gravity"] = [0, -5, 0]
            sim.save_state(self.folder / "a.state")
            sim.step(3)
            sim.load_state(self.folder / "a.state")
            sim.step(2)
            with sim.bodies[0].hold(self.corner(sim), radius=0.02) as hold:
                hold.pull([0.0, 0.5, 0.0])
                sim.step(2)
            sim.step(1)
            recording.end()
            recording.end()
            end = sim.state_hash
            sim.step(5)  # not recorded
        with c3de.replay(file, threads=1) as again:
            self.assertEqual(again.state_hash, end)
        replayed = run("replay", file, "--check", "-q", "--report", self.folder / "r.json")
        self.assertEqual(replayed.returncode, 0, replayed.stderr)
        self.assertEqual(json.loads((self.folder / "r.json").read_text())["state_hash"], end)
        with c3de.open(file) as part:
            state = part.replay(steps=2)
            self.assertEqual((state.steps, state.complete), (2, False))
            state = part.replay()
            self.assertTrue(state.complete)
            self.assertGreater(state.equal_hashes, 3)
            self.assertEqual((state.remark, part.state_hash), ("", end))

    @staticmethod
    def corner(sim):
        return sim.report()["bodies"][0]["centre_of_mass_m"]

    def test_a_recording_of_the_program_is_repeated(self):
        file = self.folder / "b.c3dr"
        made = run("run", FALLING, "--steps", "12", "-q", "--record", file, "--report", self.folder / "r.json")
        self.assertEqual(made.returncode, 0, made.stderr)
        with c3de.replay(file) as sim:
            self.assertEqual(sim.state_hash, json.loads((self.folder / "r.json").read_text())["state_hash"])
            self.assertEqual(sim.steps, 12)

    def test_a_difference_names_its_step(self):
        file = self.folder / "c.c3dr"
        with c3de.open(FALLING, threads=1) as sim, sim.record(file, hash_every=1):
            sim.step(6)
        with c3de.open(file, threads=1) as sim:
            sim.replay(steps=2)
            sim["world.gravity"] = [0, 0, -3]
            with self.assertRaises(c3de.Error) as caught:
                sim.replay()
        self.assertEqual(caught.exception.kind, "diverged")
        self.assertIn("step 3", str(caught.exception))

    def test_a_recording_that_ends_early_says_so(self):
        file = self.folder / "d.c3dr"
        with c3de.open(FALLING, threads=1) as sim, sim.record(file, hash_every=1):
            sim.step(6)
        data = file.read_bytes()
        file.write_bytes(data[:-20])
        with c3de.open(file, threads=1) as sim:
            self.assertIn("early", sim.replay().remark)

    def test_closing_completes_a_recording(self):
        file = self.folder / "e.c3dr"
        sim = c3de.open(FALLING, threads=1)
        sim.record(file)
        sim.step(3)
        end = sim.state_hash
        sim.close()
        with c3de.open(file) as again:
            self.assertEqual(again.replay().remark, "")
            self.assertEqual(again.state_hash, end)

    def test_a_recording_whose_end_was_refused_can_be_ended_later(self):
        file = self.folder / "h.c3dr"
        kinds = []
        with c3de.open(FALLING, threads=1) as sim:
            recording = sim.record(file)

            def progress(_fraction, _text):
                try:
                    recording.end()
                except c3de.Error as error:
                    kinds.append(error.kind)
                return False

            with self.assertRaises(c3de.Error) as caught:
                sim.run(until=1e4, progress=progress)
            self.assertEqual((caught.exception.kind, kinds), ("cancelled", ["state"]))
            sim.step(2)
            recording.end()
            steps, end = sim.steps, sim.state_hash
            sim.step(2)  # not recorded
            with c3de.replay(file, threads=1) as again:  # complete, while the other simulation exists
                self.assertEqual((again.steps, again.state_hash), (steps, end))

    def test_misuse_is_refused(self):
        with c3de.open(FALLING, threads=1) as sim:
            cases = [(lambda: sim.record(self.folder / "a.txt"), "argument", ".c3dr"),
                     (lambda: sim.record(self.folder / "none" / "a.c3dr"), "input or output", "none"),
                     (lambda: sim.record(self.folder / "a.c3dr", hash_every=0), "argument", "hash_every"),
                     (lambda: sim.replay(), "state", ".c3dr"),
                     (lambda: sim.replay(until=-1), "argument", "until")]
            for call, kind, text in cases:
                with self.assertRaises(c3de.Error) as caught:
                    call()
                self.assertEqual(caught.exception.kind, kind, str(caught.exception))
                self.assertIn(text, str(caught.exception))
            sim.record(self.folder / "a.c3dr")
            with self.assertRaises(c3de.Error) as caught:
                sim.record(self.folder / "b.c3dr")
            self.assertEqual(caught.exception.kind, "state")
            self.assertIn("a.c3dr", str(caught.exception))
        (self.folder / "no.c3dr").write_bytes(b"no recording")
        with self.assertRaises(c3de.Error) as caught:
            c3de.replay(self.folder / "no.c3dr")
        self.assertEqual(caught.exception.kind, "format")

    def test_cancelled_steps_of_an_implicit_solver_are_not_in_a_recording(self):
        """How far a cancelled step was depends on the time; what follows must not."""
        file = self.folder / "g.c3dr"
        cancelled = 0
        with c3de.open(CANTILEVER, threads=1, **{"solver.integrator": "implicit"}) as sim:
            with sim.record(file, hash_every=1):
                for i in range(400):
                    timer = threading.Timer(0.0005 * (i % 9), sim.cancel)
                    timer.start()
                    try:
                        sim.step()
                    except c3de.Error as error:
                        self.assertEqual(error.kind, "cancelled")
                        cancelled += 1
                    timer.join()
                    if cancelled >= 3 and sim.steps >= 10:
                        break
            end = sim.state_hash
        self.assertGreaterEqual(cancelled, 3)
        with c3de.replay(file, threads=1) as again:
            self.assertEqual(again.state_hash, end)

    def test_another_thread_cancels_a_replay(self):
        file = self.folder / "f.c3dr"
        with c3de.open(FALLING, threads=1) as sim, sim.record(file):
            sim.step(400)
        with c3de.open(file, threads=1) as sim:
            cancelled = threading.Event()

            def progress(_fraction, _text):
                cancelled.set()
                return False

            with self.assertRaises(c3de.Error) as caught:
                sim.replay(progress=progress)
            self.assertEqual(caught.exception.kind, "cancelled")
            self.assertTrue(cancelled.is_set())
            self.assertTrue(sim.replay().complete)


if __name__ == "__main__":
    unittest.main(verbosity=2)
