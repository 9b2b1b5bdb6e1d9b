# SPDX-License-Identifier: Apache-2.0
"""What was measured of a body, in Python: matching, stiffness, sensitivities."""

import os
import pathlib
import tempfile
import threading
import time
import unittest

import c3de

try:
    import numpy
except ImportError:
    numpy = None

SCENES = pathlib.Path(os.environ["C3DE_SCENES"])
RESOURCES = SCENES.parent
needs_numpy = unittest.skipIf(numpy is None, "[C3DE-SKIPPED] numpy is not installed (Debian package python3-numpy)")
LOW, HIGH = {"box": {"min": [-1, -1, -1], "max": [0.001, 1, 1]}}, {"box": {"min": [0.199, -1, -1], "max": [1, 1, 1]}}


def beam(*, moved=None, force=None, modulus=1e5, spacing=0.02):
    scene = c3de.Scene("test", solver={"integrator": "quasistatic", "tolerance_mm": 1e-6})
    scene.add("body", name="beam", mesh=str(RESOURCES / "meshes/beam.obj"), sampling={"spacing": spacing},
              material={"law": "neo_hookean", "youngs_modulus": modulus, "poisson_ratio": 0.3, "density": 1000.0})
    scene.fix("beam", LOW)
    if moved is not None:
        scene.fix("beam", HIGH, displacement=moved)
    if force is not None:
        scene.load("beam", HIGH, force=force)
    return scene.open()


def curve(displacements):
    forces = []
    for one in displacements:
        with beam(moved=[0, 0, -one]) as sim:
            sim.run()
            forces.append(-sim.report()["reactions"][1]["force_N"][2])
    return forces


class Fits(unittest.TestCase):
    def test_a_modulus_is_found_from_reactions(self):
        displacements = [0.005, 0.01, 0.015, 0.02, 0.03]
        forces = curve(displacements)
        with beam(moved=[0, 0, -0.001], modulus=7e3) as sim:
            before = sim.state_hash
            seen = []
            found = sim.bodies[0].fit(displacements, forces, progress=lambda part, text: seen.append(part))
            self.assertEqual(sim.state_hash, before)
            self.assertEqual(found.verdict, "found")
            self.assertTrue(found.converged and seen)
            self.assertEqual([one.material for one in found.moduli], ["beam"])
            self.assertAlmostEqual(found.moduli[0].value / 1e5, 1.0, 3)
            self.assertLessEqual(found.moduli[0].low, found.moduli[0].value)
            self.assertLessEqual(found.moduli[0].value, found.moduli[0].high)
            self.assertAlmostEqual(found.predicted[-1] / forces[-1], 1.0, 3)
            if numpy is not None:
                same = sim.bodies[0].fit(numpy.array(displacements), numpy.array(forces))
                self.assertEqual(same.moduli, found.moduli)
            with tempfile.TemporaryDirectory() as folder:
                file = pathlib.Path(folder) / "curve.csv"
                file.write_text("force_N,displacement_mm\n" + "".join("%r,%r\n" % (f, 1e3 * u) for u, f in
                                                                      zip(displacements, forces)))
                self.assertAlmostEqual(sim.bodies[0].fit(file).moduli[0].value / found.moduli[0].value, 1.0, 9)

    @needs_numpy
    def test_a_modulus_is_found_from_displacements(self):
        forces, displacements = [0.05, 0.1, 0.15, 0.2], []
        for force in forces:
            with beam(force=[0, 0, -force]) as sim:
                sim.run()
                surface = sim.bodies[0].surface
                rest = surface.field("reference_position")
                last = int(numpy.argmax(rest[:, 0]))
                point = rest[last]
                displacements.append(-surface.field("displacement")[last, 2])
        with beam(force=[0, 0, -1.0], modulus=3e5) as sim:
            found = sim.bodies[0].fit(displacements, forces, at=point)
        self.assertEqual(found.verdict, "found")
        self.assertAlmostEqual(found.moduli[0].value / 1e5, 1.0, 3)

    def test_wrong_curves_are_refused(self):
        good = [0.005, 0.01, 0.015, 0.02]
        with beam(moved=[0, 0, -0.001]) as sim:
            for arguments, kind, text in (((good, [1, 2, 3]), "argument", "force has 3 values; accepted: 4"),
                                          ((good,), "argument", "force is missing"),
                                          ((good, [1, 2, float("nan"), 4]), "format", "point 3"),
                                          ((good[::-1], good), "format", "decreases"),
                                          ((good, [-1, -2, -3, -4]), "format", "against the displacement"),
                                          (("no.csv",), "format", "no.csv"),
                                          ((good, good), None, None)):
                with self.subTest(arguments=arguments):
                    if kind is None:
                        sim.bodies[0].fit(*arguments)
                        continue
                    with self.assertRaises(c3de.Error) as raised:
                        sim.bodies[0].fit(*arguments)
                    self.assertEqual(raised.exception.kind, kind)
                    self.assertIn(text, str(raised.exception))
        with beam() as sim, self.assertRaisesRegex(c3de.Error, "0 supports move and 0 forces act"):
            sim.bodies[0].fit(good, good)

    def test_a_fit_is_cancelled(self):
        with beam(moved=[0, 0, -0.001]) as sim:
            with self.assertRaises(c3de.Error) as raised:
                sim.bodies[0].fit([0.005, 0.01, 0.015, 0.02], [1, 2, 3, 4], progress=lambda part, text: False)
            self.assertEqual(raised.exception.kind, "cancelled")
            sim.run()


@needs_numpy
class Matches(unittest.TestCase):
    MOTION = numpy.array([0.12, -0.045, 0.08]) if numpy is not None else None

    def test_the_points_of_the_example_are_matched(self):
        match = c3de.match(SCENES / "first_light.toml", RESOURCES / "match/organ_points.csv", noise=1e-3)
        self.assertEqual(match.verdict, "found")
        self.assertLess(match.rms["rigid"], 1.3e-3)
        self.assertGreater(match.rms["before"], 0.05)
        self.assertEqual(len(match.candidates), 1)
        self.assertAlmostEqual(match.motion[3][3], 1.0)
        self.assertEqual(match.displacement.shape[1], 3)
        self.assertGreater(numpy.abs(match.displacement).max(), 0.0)
        self.assertGreater(match.expected_error, 0.0)
        self.assertIsNone(match.landmark_errors)
        match.body.simulation.close()

    def test_a_moved_body_is_found_and_followed(self):
        with c3de.open(SCENES / "first_light.toml") as sim:
            body = sim.body("organ")
            rest = body.surface.field("reference_position")
            points = rest[::7] + self.MOTION
            landmarks = {"one": (rest[0], rest[0] + self.MOTION), "other": (rest[50], rest[50] + self.MOTION)}
            match = body.match(points, landmarks=landmarks, noise=5e-4)
            self.assertEqual(match.verdict, "found")
            for axis in range(3):
                self.assertAlmostEqual(match.motion[axis][3], self.MOTION[axis], delta=2e-3)
            self.assertLess(match.landmark_errors["rigid"]["max"], 2e-3)
            begin = time.perf_counter()
            further = body.match(points + [0.002, 0.0, 0.0], noise=5e-4, follow=True)
            self.assertEqual(further.verdict, "given")
            self.assertAlmostEqual(further.motion[0][3], self.MOTION[0] + 0.002, delta=1e-3)
            self.assertLess(time.perf_counter() - begin, 10.0)
            with tempfile.TemporaryDirectory() as folder:
                session = pathlib.Path(folder) / "matched.c3de"
                sim.save_session(session)
                with c3de.open(session) as again:
                    self.assertEqual(again.state_hash, sim.state_hash)

    def test_rigid_and_in_place(self):
        with c3de.open(SCENES / "first_light.toml") as sim:
            body = sim.body("organ")
            rest = body.surface.field("reference_position")
            rigid = body.match(rest[::7] + self.MOTION, deform=False)
            self.assertEqual(rigid.verdict, "found")
            self.assertNotIn("after", rigid.rms)
            self.assertEqual(numpy.abs(body.points.field("displacement")).max(), 0.0)
            given = body.match(rest[::7] + [0.001, 0, 0], rigid_first=False)
            self.assertEqual(given.verdict, "given")
            self.assertEqual(given.motion[0], [1.0, 0.0, 0.0, 0.0])

    def test_wrong_points_are_refused(self):
        with c3de.open(SCENES / "first_light.toml") as sim:
            body, before = sim.body("organ"), sim.state_hash
            good = body.surface.vertices[::40]
            bad = good.copy()
            bad[3, 1] = numpy.nan
            for points, options, kind, text in ((good[:5], {}, "format", "12"), (bad, {}, "argument", "points_m[3]"),
                                                (good[:, :2], {}, "argument", "row of 2 numbers"),
                                                (good, {"noise": 0.0}, "argument", "noise"),
                                                (good, {"use": "look"}, "argument", "look"),
                                                (good, {"normals": good[:4]}, "argument", "one per point"),
                                                ("no.csv", {}, "format", "no.csv")):
                with self.subTest(text=text):
                    with self.assertRaises(c3de.Error) as raised:
                        body.match(points, **options)
                    self.assertEqual(raised.exception.kind, kind, raised.exception)
                    self.assertIn(text, str(raised.exception))
            self.assertEqual(sim.state_hash, before)

    def test_another_thread_cancels(self):
        with c3de.open(SCENES / "first_light.toml") as sim:
            body = sim.body("organ")
            started = threading.Event()

            def cancel():
                started.wait(30)
                sim.cancel()

            thread = threading.Thread(target=cancel)
            thread.start()
            with self.assertRaises(c3de.Error) as raised:
                body.match(body.surface.vertices[::40] + self.MOTION, progress=lambda part, text: started.set())
            thread.join()
            self.assertEqual(raised.exception.kind, "cancelled")


@needs_numpy
class Sensitivities(unittest.TestCase):
    def objective(self, **options):
        with beam(**options) as sim:
            sim.run()
            return float(numpy.sum(sim.bodies[0].points.field("displacement")[:, 2] ** 2))

    # Central differences of solutions to a tolerance of 1e-9 m.
    def test_derivatives_are_those_of_differences(self):
        moved = numpy.array([0.001, 0.0, -0.01])
        with beam(moved=moved) as sim:
            sim.run()
            body = sim.bodies[0]
            u = body.points.field("displacement").copy()
            u[:, :2] = 0.0
            found = body.sensitivity(2 * u)
            self.assertEqual(found.forces.shape, u.shape)
            self.assertEqual([one.fix for one in found.supports], [0, 1])
            self.assertEqual(found.surroundings_stiffness, 0.0)
        step = 1e-4
        for axis in (0, 2):
            shift = step * numpy.eye(3)[axis]
            should = (self.objective(moved=moved + shift) - self.objective(moved=moved - shift)) / (2 * step)
            self.assertAlmostEqual(found.supports[1].displacement[axis] / should, 1.0, 2)
        force = numpy.array([0, 0, -0.1])
        with beam(force=force) as sim:
            sim.run()
            u = sim.bodies[0].points.field("displacement").copy()
            u[:, :2] = 0.0
            found = sim.bodies[0].sensitivity(2 * u)
        step = 1e3
        above, below = (self.objective(force=force, modulus=1e5 + change) for change in (step, -step))
        should = (above - below) / (2 * step)
        self.assertAlmostEqual(found.moduli["beam"] / should, 1.0, 3)

    def test_tissues_have_unique_names(self):
        # Two labels across a bar, the first with the name of the body.
        voxels = [(1 if i < 6 else 2) if 0 < i < 11 and 0 < j < 3 and 0 < k < 3 else 0
                  for k in range(4) for j in range(4) for i in range(12)]
        header = ("NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: 12 4 4\n"
                  "space directions: (10,0,0) (0,10,0) (0,0,10)\nspace origin: (0,0,0)\nencoding: ascii\n"
                  "Segment0_LabelValue:=1\nSegment0_Name:=beam\nSegment1_LabelValue:=2\nSegment1_Name:=soft\n\n")
        with tempfile.TemporaryDirectory() as folder:
            labels = pathlib.Path(folder) / "labels.nrrd"
            labels.write_text(header + " ".join(map(str, voxels)) + "\n")
            scene = c3de.Scene("labels", solver={"integrator": "quasistatic"}, world={"gravity": [0, 0, -1]})
            scene.add("body", name="beam", volume=str(labels), sampling={"spacing": 0.01},
                      tissues=[{"label": name, "material": {"youngs_modulus": modulus}}
                               for name, modulus in (("beam", 2e4), ("soft", 1e4))])
            scene.fix("beam", {"half_space": {"point": [0.006, 0, 0], "normal": [1, 0, 0]}})
            with scene.open() as sim:
                sim.run()
                body = sim.bodies[0]
                found = body.sensitivity(numpy.ones((len(body.points), 3)))
        self.assertEqual(list(found.moduli), ["beam", "beam.parts.0", "soft"])
        self.assertNotEqual(found.moduli["beam.parts.0"], 0.0)

    def test_another_thread_cancels_a_sensitivity(self):
        with beam(spacing=0.0025, force=[0, 0, -0.1]) as sim:
            sim.run()
            body = sim.bodies[0]
            ended = threading.Event()

            def cancel():
                while not ended.wait(0.001):
                    sim.cancel()

            thread = threading.Thread(target=cancel)
            thread.start()
            with self.assertRaises(c3de.Error) as raised:
                body.sensitivity(numpy.ones((len(body.points), 3)))
            ended.set()
            thread.join()
            self.assertEqual(raised.exception.kind, "cancelled")
            # The solution is unchanged and can be differentiated.
            self.assertGreater(numpy.abs(body.sensitivity(numpy.ones((len(body.points), 3))).forces).max(), 0.0)

    def test_what_is_not_static_is_refused(self):
        with c3de.open(SCENES / "first_light.toml") as sim:
            body = sim.body("organ")
            with self.assertRaisesRegex(c3de.Error, "not static"):
                body.sensitivity(numpy.zeros((len(body.points), 3)))
            with self.assertRaisesRegex(c3de.Error, "accepted"):
                body.sensitivity(numpy.zeros((3, 3)))
            with self.assertRaisesRegex(c3de.Error, "shape"):
                body.sensitivity(numpy.zeros(3))


if __name__ == "__main__":
    unittest.main(verbosity=2)
