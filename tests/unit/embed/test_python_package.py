# SPDX-License-Identifier: Apache-2.0
"""The Python package over libc3de, with what is installed: without numpy the cases with arrays are skipped."""

import concurrent.futures
import gc
import json
import multiprocessing
import os
import pathlib
import pickle
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import c3de
from c3de._values import _text as text_of

try:
    import numpy
except ImportError:
    numpy = None

SCENES = pathlib.Path(os.environ["C3DE_SCENES"])
CANTILEVER = SCENES / "cantilever.toml"
FALLING = SCENES / "first_light.toml"
STIFFNESS = "body.beam.youngs_modulus"
needs_numpy = unittest.skipIf(numpy is None, "[C3DE-SKIPPED] numpy is not installed (Debian package python3-numpy)")

BOX = [[x, y, z] for x in (0, 0.2) for y in (0, 0.1) for z in (0, 0.1)]
BOX_FACES = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4],
             [1, 5, 7], [1, 7, 3]]


MPIRUN = ["mpirun", "--allow-run-as-root", "--oversubscribe", "-n"]
MPI_SWEEP = """import c3de
from mpi4py.futures import MPIPoolExecutor
if __name__ == "__main__":
    with MPIPoolExecutor() as executor:
        for row in c3de.sweep(%r, {%r: [5e5, 1e6]}, steps=5, executor=executor):
            print(row.report["state_hash"])
"""


def mpi_runs():
    try:
        program = [*MPIRUN, "1", sys.executable, "-c", "import mpi4py.futures"]
        return subprocess.run(program, capture_output=True, timeout=60).returncode == 0
    except (OSError, subprocess.TimeoutExpired):
        return False


def report_of_program(scene, *options):
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "report.json"
        subprocess.run([os.environ["C3DE_PROGRAM"], "run", str(scene), "-q", "--report", str(file), *options], check=True)
        return json.loads(file.read_text())


class Running(unittest.TestCase):
    def test_same_state_hash_as_the_program(self):
        with c3de.open(CANTILEVER, **{STIFFNESS: 8e5}) as sim:
            sim.run()
            report = report_of_program(CANTILEVER, "--set", "body.beam.material.youngs_modulus=8e5")
            self.assertEqual(sim.state_hash, report["state_hash"])
            self.assertEqual(sim.report()["state_hash"], report["state_hash"])
            self.assertTrue(sim.status.finished and sim.status.quasistatic)
        with c3de.open(FALLING) as sim:
            sim.run(until=0.02)
            self.assertEqual(sim.state_hash, report_of_program(FALLING, "--until", "0.02")["state_hash"])
            self.assertGreaterEqual(sim.time, 0.02 - 1e-6)

    def test_the_program_prints_the_folder_of_this_package(self):
        printed = subprocess.run([os.environ["C3DE_PROGRAM"], "python-path"], check=True, text=True, capture_output=True).stdout
        self.assertTrue(pathlib.Path(printed.strip(), "c3de").samefile(pathlib.Path(c3de.__file__).parent))

    def test_steps_are_counted(self):
        with c3de.open(FALLING) as sim:
            self.assertEqual(sim.step(3), 3)
            self.assertEqual(sim.step(), 1)
            self.assertEqual(sim.step(0), 0)
            self.assertEqual(sim.steps, 4)
            sim.run(steps=2)
            self.assertEqual(sim.steps, 6)
            sim.reset()
            self.assertEqual(sim.steps, 0)

    def test_parameters(self):
        with c3de.open(CANTILEVER) as sim:
            self.assertEqual(sim[STIFFNESS], 1e6)
            sim[STIFFNESS] = 8e5
            self.assertEqual(sim["body.beam.material.youngs_modulus"], 8e5)
            sim["world.gravity"] = (0, 0, -1)
            self.assertEqual(sim["world.gravity"], (0.0, 0.0, -1.0))
            self.assertEqual(sim["body.beam.material.law"], "neo_hookean")
            self.assertIn("body.beam.material.youngs_modulus", [one.path for one in sim.parameters()])

    def test_errors_have_text_and_kind(self):
        cases = [(lambda: c3de.open("missing.toml"), "format", "missing.toml"),
                 (lambda: c3de.open(CANTILEVER, **{"body.beam.material.youngs": 1}), "argument", "youngs_modulus"),
                 (lambda: c3de.open(), "argument", "path")]
        with c3de.open(CANTILEVER) as sim:
            cases += [(lambda: sim.body("liver"), "not found", "beam"),
                      (lambda: sim["body.beam.poison_ratio"], "argument", "poisson_ratio"),
                      (lambda: sim.__setitem__("body.beam.poisson_ratio", 0.7), "argument", "accepted"),
                      (lambda: sim.__setitem__(STIFFNESS, float("nan")), "argument", "nan"),
                      (lambda: sim.run(until=-1.0), "argument", "until"),
                      (lambda: sim.body("beam").hold([0, 0], 0.01), "argument", "at"),
                      (lambda: sim.load_state(CANTILEVER), "format", "state")]
            for call, kind, text in cases:
                with self.assertRaises(c3de.Error) as caught:
                    call()
                self.assertEqual(caught.exception.kind, kind, str(caught.exception))
                self.assertIn(text, str(caught.exception))
        with self.assertRaises(c3de.Error) as caught:
            sim.step()
        self.assertEqual(caught.exception.kind, "closed")
        self.assertIn("closed", repr(sim))
        sim.close()
        same = pickle.loads(pickle.dumps(caught.exception))
        self.assertEqual((str(same), same.kind), (str(caught.exception), "closed"))

    def test_states_and_sessions_return_bit_for_bit(self):
        with tempfile.TemporaryDirectory() as folder, c3de.open(FALLING) as sim:
            state, session = pathlib.Path(folder) / "a.state", pathlib.Path(folder) / "a.c3de"
            sim.step(3)
            saved = sim.state_hash
            sim.save_state(state)
            sim.save_session(session)
            sim.step(2)
            sim.load_state(state)
            self.assertEqual(sim.state_hash, saved)
            with c3de.open(session) as continued:
                self.assertEqual(continued.state_hash, saved)

    def test_progress_and_cancelling_by_it(self):
        seen = []
        with c3de.open(FALLING) as sim:
            with self.assertRaises(c3de.Error) as caught:
                sim.run(until=1e4, progress=lambda fraction, text: seen.append(text) or len(seen) < 2)
            self.assertEqual(caught.exception.kind, "cancelled")
            self.assertEqual(len(seen), 2)
            with self.assertRaises(ZeroDivisionError):
                sim.run(until=1e4, progress=lambda fraction, text: 1 / 0)
            self.assertEqual(sim.step(), 1)

    def test_another_thread_cancels(self):
        with c3de.open(FALLING) as sim:
            over = threading.Event()

            def cancel():
                while not over.wait(0.01):
                    sim.cancel()

            thread = threading.Thread(target=cancel)
            thread.start()
            with self.assertRaises(c3de.Error) as caught:
                sim.run(until=1e4)
            over.set()
            thread.join()
            self.assertEqual(caught.exception.kind, "cancelled")

    def test_a_refused_close_can_be_repeated(self):
        sim = c3de.open(FALLING)
        kinds = []

        def progress(_fraction, _text):
            for call in sim.close, sim.step, sim.reset:
                try:
                    call()
                except c3de.Error as error:
                    kinds.append(error.kind)
            self.assertEqual(sim.report()["steps"], sim.steps)
            return False

        with self.assertRaises(c3de.Error):
            sim.run(until=1e4, progress=progress)
        self.assertEqual(kinds, ["state"] * 3)
        self.assertEqual(sim.step(), 1)
        sim.close()
        sim.close()
        with self.assertRaises(c3de.Error):
            sim.step()

    def test_threads_step_and_read_one_simulation(self):
        failures = []
        with c3de.open(FALLING) as sim:
            def read():
                try:
                    for _ in range(20):
                        self.assertIn("bodies", sim.report())
                        sim.events(), sim.parameters(), sim.bodies[0].name
                        sim.step()
                except BaseException as error:
                    failures.append(error)

            threads = [threading.Thread(target=read) for _ in range(4)]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
            self.assertEqual(failures, [])
            self.assertEqual(sim.steps, 80)

    def test_closing_ends_the_run_of_another_thread(self):
        sim = c3de.open(FALLING)
        kinds = []
        running = threading.Event()

        def run():
            try:
                sim.run(until=1e5, progress=lambda _fraction, _text: running.set())
            except c3de.Error as error:
                kinds.append(error.kind)

        thread = threading.Thread(target=run)
        thread.start()
        self.assertTrue(running.wait(60))
        sim.close()
        thread.join()
        self.assertEqual(kinds, ["cancelled"])

    def test_forgotten_simulations_are_closed(self):
        for _ in range(20):
            c3de.open(CANTILEVER, threads=1)
        gc.collect()
        self.assertLess(threading.active_count(), 5)
        self.assertLess(len(os.listdir("/proc/self/task")), 20)

    @unittest.skipUnless(hasattr(signal, "SIGINT") and os.name == "posix", "signals of POSIX")
    def test_interrupt_ends_a_run_and_the_simulation_continues(self):
        program = ("import c3de, sys\n"
                   "sim = c3de.open(%r)\n"
                   "sim.step()\n"
                   "print('running', flush=True)\n"
                   "try:\n"
                   "    sim.run(until=1e5)\n"
                   "except KeyboardInterrupt:\n"
                   "    print('interrupted', sim.step())\n" % str(FALLING))
        process = subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True)
        self.assertEqual(process.stdout.readline(), "running\n")
        time.sleep(0.3)
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.communicate(timeout=60)[0], "interrupted 1\n")
        self.assertEqual(process.returncode, 0)

    @unittest.skipUnless(hasattr(signal, "SIGINT") and os.name == "posix", "signals of POSIX")
    def test_interrupts_at_any_moment_of_a_solve_leave_a_complete_state(self):
        """Signals at random moments: in a solve, between two, at the beginning and the end of a call."""
        program = ("import c3de, random, signal, threading, time, os, sys\n"
                   "interrupts = 0\n"
                   "with c3de.open(%r, threads=1) as sim:\n"
                   "    random.seed(7)\n"
                   "    over = threading.Event()\n"
                   "    armed = threading.Event()\n"
                   "    def disturb():\n"
                   "        while not over.is_set():\n"
                   "            time.sleep(random.uniform(0.0, 0.02))\n"
                   "            if armed.is_set():\n"
                   "                os.kill(os.getpid(), signal.SIGINT)\n"
                   "                time.sleep(0.005)\n"
                   "    thread = threading.Thread(target=disturb)\n"
                   "    thread.start()\n"
                   "    while not sim.status.finished and interrupts < 40:\n"
                   "        before = sim.steps\n"
                   "        try:\n"
                   "            try:\n"
                   "                armed.set()\n"
                   "                sim.run()\n"
                   "            finally:\n"
                   "                armed.clear()\n"
                   "        except KeyboardInterrupt:\n"
                   "            interrupts += 1\n"
                   "        assert before <= sim.steps, (before, sim.steps)\n"
                   "    over.set()\n"
                   "    while True:\n"
                   "        try:\n"
                   "            thread.join()\n"
                   "            break\n"
                   "        except KeyboardInterrupt:\n"
                   "            pass\n"
                   "    sim.run()\n"
                   "    print(sim.steps, interrupts > 0, *sim.report()['probes'][0]['position_m'])\n" % str(CANTILEVER))
        ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=200)
        self.assertEqual((ended.returncode, ended.stderr), (0, ""))
        steps, disturbed, *position = ended.stdout.split()
        with c3de.open(CANTILEVER, threads=1) as sim:
            sim.run()
            self.assertEqual((int(steps), disturbed), (sim.steps, "True"))
            # Solvers start anew after a cancelled step.
            for own, alone in zip(position, sim.report()["probes"][0]["position_m"]):
                self.assertAlmostEqual(float(own), alone, delta=1e-7)

    def test_a_body_that_has_stopped_is_counted_while_the_others_go_on(self):
        scene = c3de.Scene("two", world={"gravity": [0, -9.81, 0]}, solver={"integrator": "explicit", "dt": 0.02})
        box = [[x, 0.4 * y - 0.02, 0.4 * z - 0.02] for x, y, z in BOX]
        for name, spin, height in ("torn", 3000, 0), ("whole", 0, 1000):  # rad/s: faster than its waves
            scene.body(name, box, BOX_FACES, position=[0, height, 0], angular_velocity=[0, 0, spin],
                       material={"youngs_modulus": 1e4, "poisson_ratio": 0.3, "density": 1000.0},
                       sampling={"spacing": 0.02})
        with scene.open(threads=1) as sim:
            self.assertEqual(sim.step(5), 5)
            self.assertEqual((sim.status.stopped, sim.status.bodies), (1, 2))
            report = sim.report()
            self.assertIn("torn", report["bodies"][0]["stopped"])
            self.assertEqual(report["bodies"][1]["stopped"], "")
            self.assertTrue(any("torn" in event.text for event in sim.events()))
            self.assertLess(report["bodies"][1]["centre_of_mass_m"][1], 1000.0)
            with self.assertRaises(c3de.Error) as caught:
                sim.run(steps=2)
            self.assertEqual(caught.exception.kind, "diverged")
            self.assertIn("1 body has stopped", str(caught.exception))
            self.assertEqual(sim.steps, 7)
            sim.reset()
            self.assertEqual(sim.status.stopped, 0)

    def test_a_process_with_open_simulations_ends_quietly(self):
        program = "import c3de\nsim = c3de.open(%r)\nsim.step(2)\n" % str(FALLING)
        ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=120)
        self.assertEqual((ended.returncode, ended.stdout, ended.stderr), (0, "", ""))

    def test_hold(self):
        with c3de.open(CANTILEVER, **{"solver.integrator": "explicit", "world.gravity": [0, 0, 0]}) as sim:
            with sim.body("beam").hold([0.2, 0, 0], 0.02) as hold:
                hold.pull([0.2, 0, 0.01])
                sim.step(20)
                self.assertGreater(hold.force[2], 0.0)
                self.assertGreater(hold.point[2], 0.0)
            with self.assertRaises(c3de.Error):
                hold.force


@unittest.skipUnless(hasattr(os, "fork"), "[C3DE-SKIPPED] this system has no fork")
class Forking(unittest.TestCase):
    PROGRAM = """import os, signal, sys, c3de
scene = sys.argv[1]
sim = c3de.open(scene, threads=2)
sim.step(2)
if os.fork() == 0:
    signal.alarm(60)
    for call in (lambda: sim.step(), lambda: sim.steps, lambda: sim.close()):
        try:
            call()
        except c3de.Error as error:
            print(error.kind, "before this process was forked" in str(error))
    with c3de.open(scene, threads=2) as other:
        other.step(2)
        print(other.state_hash)
    sys.exit(0)  # its finalisers end, too
_, status = os.wait()
print(os.WEXITSTATUS(status), os.WIFSIGNALED(status), sim.state_hash)
sim.step(2)
"""

    def test_a_forked_process_refuses_what_its_parent_opened_and_opens_its_own(self):
        done = subprocess.run([sys.executable, "-B", "-c", self.PROGRAM, str(CANTILEVER)], capture_output=True, text=True,
                              timeout=120)
        self.assertEqual(done.returncode, 0, done.stderr)
        lines = done.stdout.splitlines()
        self.assertEqual(lines[:3], ["closed True"] * 3)
        self.assertEqual(lines[4], "0 False " + lines[3])


class Sweeping(unittest.TestCase):
    def test_a_sweep_yields_every_combination_in_order(self):
        rows = list(c3de.sweep(CANTILEVER, {STIFFNESS: [5e5, 1e6, -1.0]}, jobs=2))
        self.assertEqual([row.values[STIFFNESS] for row in rows], [5e5, 1e6, -1.0])
        self.assertEqual(rows[1].report["state_hash"], report_of_program(CANTILEVER)["state_hash"])
        sag = [row.report["probes"][0]["position_m"][2] for row in rows[:2]]
        self.assertLess(sag[0], sag[1])
        self.assertIsNone(rows[2].report)
        self.assertIn("youngs_modulus", str(rows[2].error))
        self.assertRegex(repr(rows[0]), r"^<c3de.SweepRow %s = 500000.0: done after \d+ steps>$" % STIFFNESS)
        self.assertIn(str(rows[2].error), repr(rows[2]))

    def test_an_executor_computes_the_same_rows(self):
        values = {STIFFNESS: [5e5, -1.0]}
        expected = list(c3de.sweep(CANTILEVER, values, steps=5))
        context = multiprocessing.get_context("spawn")
        with concurrent.futures.ProcessPoolExecutor(2, mp_context=context) as executor:
            rows = list(c3de.sweep(CANTILEVER, values, steps=5, executor=executor))
        self.assertEqual(rows[0].report["state_hash"], expected[0].report["state_hash"])
        self.assertEqual(str(rows[1].error), str(expected[1].error))
        with self.assertRaisesRegex(c3de.Error, "threads is 0; accepted: >= 1"):
            next(c3de.sweep(CANTILEVER, values, threads=0))

    @unittest.skipUnless(mpi_runs(), "[C3DE-SKIPPED] mpi4py or mpirun is not installed (Debian packages python3-mpi4py, "
                                     "openmpi-bin)")
    def test_mpi4py_computes_the_same_rows(self):
        expected = [row.report["state_hash"] for row in c3de.sweep(CANTILEVER, {STIFFNESS: [5e5, 1e6]}, steps=5)]
        with tempfile.TemporaryDirectory() as folder:
            script = pathlib.Path(folder) / "sweep.py"
            script.write_text(MPI_SWEEP % (str(CANTILEVER), STIFFNESS))
            done = subprocess.run([*MPIRUN, "3", sys.executable, "-B", "-m", "mpi4py.futures", str(script)],
                                  capture_output=True, text=True, timeout=120)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(done.stdout.split(), expected)


class Scenes(unittest.TestCase):
    def scene(self):
        scene = c3de.Scene("block \"1\"", world={"gravity": [0, 0, -9.81]}, solver={"integrator": "quasistatic"})
        scene.body("block", BOX, BOX_FACES, material={"law": "neo_hookean", "youngs_modulus": 1e6, "density": 1000.0},
                   sampling={"spacing": 0.02})
        scene.fix("block", {"box": {"min": [-1e-6, -1, -1], "max": [1e-6, 1, 1]}})
        return scene.probe("tip", "block", [0.2, 0.05, 0.05])

    def test_a_scene_of_lists_bends_under_gravity(self):
        with self.scene().open() as sim:
            sim.run()
            report = sim.report()
            self.assertEqual(report["scene"], 'block "1"')
            self.assertLess(report["probes"][0]["position_m"][2], 0.05)
            self.assertAlmostEqual(sim.body("block").mass, 2.0, delta=0.02)

    def test_keys_with_other_letters_are_quoted(self):
        self.assertIn('{ "é" = 1, a-b_1 = true }', c3de.Scene().add("x", one={"é": 1, "a-b_1": True}).text)

    def test_wrong_arrays_are_refused(self):
        for vertices, faces, text in ([[0, 1]], [], "3"), (BOX, [[0, 1, 9]], "0 to 7"):
            with self.assertRaises(c3de.Error) as caught:
                c3de.Scene().body("a", vertices, faces)
            self.assertIn(text, str(caught.exception))


@needs_numpy
class Arrays(unittest.TestCase):
    def test_arrays_are_snapshots_that_outlive_the_simulation(self):
        sim = c3de.open(FALLING)
        sim.step(2)
        points, surface = sim.bodies[0].points, sim.bodies[0].surface
        x, u = points.field("position"), points.field("displacement")
        self.assertEqual(x.shape, (len(points), 3))
        self.assertTrue(numpy.array_equal(u, x - points.field("reference_position")))
        self.assertEqual(points.fields["displacement"], "m")
        self.assertEqual(points.field("mass").shape, (len(points),))
        self.assertAlmostEqual(points.field("mass").sum(), sim.bodies[0].mass, places=6)
        with self.assertRaises(ValueError):
            x[0, 0] = 1.0
        kept = x.copy()
        sim.step(2)
        self.assertTrue(numpy.array_equal(x, kept))
        self.assertFalse(numpy.array_equal(points.position, kept))
        triangles, vertices = surface.triangles, surface.vertices
        self.assertEqual(triangles.shape[1], 3)
        self.assertLess(triangles.max(), len(vertices))
        sim.close()
        del sim
        gc.collect()
        self.assertTrue(numpy.array_equal(x, kept))
        corners = vertices[triangles]
        volume = numpy.einsum("ij,ij->", corners[:, 0], numpy.cross(corners[:, 1], corners[:, 2])) / 6
        self.assertGreater(volume, 0.0)

    def test_unknown_fields_are_named(self):
        with c3de.open(CANTILEVER) as sim, self.assertRaises(c3de.Error) as caught:
            sim.body("beam").points.field("colour")
        self.assertEqual(caught.exception.kind, "not found")
        self.assertIn("stress_vm", str(caught.exception))

    def test_numbers_of_numpy_are_numbers(self):
        cases = [(numpy.int64(5), "5"), (numpy.uint8(5), "5"), (numpy.bool_(True), "true"), (numpy.float64(0.5), "0.5"),
                 (numpy.float32(0.5), "0.5"), (numpy.array(7), "7"), (numpy.array(0.25), "0.25"),
                 (numpy.array([1, 2]), "[1, 2]"), ([numpy.bool_(False), numpy.float64(2)], "[false, 2.0]")]
        for value, text in cases:
            self.assertEqual(text_of(value), text)
            self.assertIn("\na = %s\n" % text, c3de.Scene().add("x", a=value).text)
        with c3de.open(CANTILEVER, **{STIFFNESS: numpy.float64(8e5)}) as sim:
            self.assertEqual(sim[STIFFNESS], 8e5)
            sim["world.gravity"] = numpy.array([0, 0, -2])
            self.assertEqual(sim["world.gravity"], (0.0, 0.0, -2.0))

    def test_a_scene_of_arrays(self):
        scene = c3de.Scene("array").body("a", numpy.array(BOX), numpy.array(BOX_FACES), sampling={"spacing": 0.02})
        with scene.open() as sim:
            self.assertEqual(sim.body("a").surface.vertices.shape, (8, 3))


if __name__ == "__main__":
    unittest.main(verbosity=2)
