# SPDX-License-Identifier: GPL-3.0-or-later
"""Studies: points, runs in processes, tables, and their continuation."""

import csv
import json
import os
import signal
import subprocess
import tempfile
import unittest
import warnings
from pathlib import Path

import numpy as np

import suture
from in_folder import InFolder
from scenes import bar

E = "/models/0/parameters/E"


def tip(sim):
    sim.run()
    return {"tip": sim.position[:, 1].min()}


class Points(unittest.TestCase):
    def test_a_grid(self):
        points = suture.grid({"/a": [1, 2], "/b": [3, 4, 5]})
        self.assertEqual(points[:4], [{"/a": 1, "/b": 3}, {"/a": 1, "/b": 4}, {"/a": 1, "/b": 5},
                                      {"/a": 2, "/b": 3}])

    def test_a_latin_hypercube_uses_each_part_once(self):
        points = suture.latin_hypercube({"/a": (10, 20), "/b": (1, 1e4)}, 50, seed=3, log=["/b"])
        parts = np.array([[(p["/a"] - 10) / 10, np.log10(p["/b"]) / 4] for p in points]) * 50
        for column in parts.T:
            self.assertEqual(sorted(column.astype(int)), list(range(50)))
        again = suture.latin_hypercube({"/a": (10, 20), "/b": (1, 1e4)}, 50, seed=3, log=["/b"])
        self.assertEqual(points, again)

    def test_bad_points(self):
        for make, text in [
            (lambda: suture.grid({"a": [1]}), "JSON pointer"),
            (lambda: suture.latin_hypercube({"/a": (2, 1)}, 5), "low < high"),
            (lambda: suture.latin_hypercube({"/a": (0, 1)}, 5, log=["/a"]), "> 0"),
            (lambda: suture.latin_hypercube({"/a": (0, 1)}, 5, log=["/b"]), "no range"),
            (lambda: suture.sweep(bar(), {"/a": []}), "no run"),
            (lambda: suture.sweep(bar(), {E: [1e5]}, jobs=-1), "jobs must be a whole number >= 1"),
            (lambda: suture.latin_hypercube({"/a": (0, 1)}, 10**9), "at most 1,000,000"),
            (lambda: suture.latin_hypercube({"/a": (0, 1)}, "x"), "whole number >= 1, is 'x'"),
            (lambda: suture.grid({f"/{i}": [0] * 100 for i in range(4)}), "100,000,000 runs"),
        ]:
            with self.assertRaisesRegex(ValueError, text):
                make()


class Runs(InFolder):
    def test_results_are_those_of_single_runs(self):
        stiffness = [5e4, 1e5, 2e5, 4e5, 8e5]
        results = suture.sweep(bar(), {E: stiffness}, 2, measure=tip, folder="study")
        np.testing.assert_array_equal(results[E], stiffness)
        alone = [tip(suture.Simulation(bar(), {E: e}))["tip"] for e in stiffness]
        np.testing.assert_array_equal(results["tip"], alone)
        with open("study/results.csv") as table:
            rows = list(csv.DictReader(table))
        self.assertEqual([float(row["tip"]) for row in rows], alone)
        self.assertEqual({row["outcome"] for row in rows}, {"finished"})
        self.assertEqual(len({row["scene_hash"] for row in rows}), 5)
        self.assertEqual({row["suture"] for row in rows}, {suture.__version__})
        with self.assertRaisesRegex(KeyError, "the columns are run, "):
            results["top"]

    def test_a_local_function_and_energies(self):
        floor = -0.1
        results = suture.sweep(bar(), [{E: 1e5}], measure=lambda sim: {"floor": floor})
        self.assertEqual(results["floor"], [floor])
        results = suture.sweep(bar(), [{E: 1e5}], folder="other")
        self.assertGreater(results["gravity"][0], 0)

    def caught_in_sweep(self, *arguments, **more):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            suture.sweep(*arguments, **more)
        return [str(warning.message) for warning in caught]

    def test_a_warning_of_all_runs_is_shown_once(self):
        def measure(sim):
            warnings.warn(f"E of {1 / sim.dt} is unusual")
            if sim.position.size == 0:
                warnings.warn("never")
            return {}

        values = {E: [1e5, 2e5, 3e5]}
        once, = self.caught_in_sweep(bar(dt="auto"), values, 1, measure=measure)
        self.assertRegex(once, r"^E of [\d.]+ is unusual \(run 0, and 2 more\)$")
        self.assertEqual(self.caught_in_sweep(bar(dt="auto"), values, 1, measure=measure), [])

    def test_the_mesh_is_read_once(self):
        sling = Path(__file__).parents[2] / "docs" / "scenes" / "gmsh-sling.msh"
        Path("mine.msh").write_text(sling.read_text())  # has quadrilaterals, which are skipped
        scene = {**bar(dt=1e-5, end=1e-3), "mesh": {"file": "mine.msh", "scale": 1e-3},
                 "constraints": [{"fix": "xyz", "where": {"set": "left end"}}]}
        values = {E: [1e5, 2e5, 3e5]}
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            alone = [tip(suture.Simulation(scene, {E: e}))["tip"] for e in values[E]]
        texts = self.caught_in_sweep(scene, values, 1, measure=tip, folder="a",
                                     report=lambda done, every: Path("mine.msh").write_text("x"))
        self.assertEqual(len(texts), 1, texts)
        self.assertIn("skipped 32 quadrilaterals", texts[0])
        results = suture.read_results("a")
        np.testing.assert_array_equal(results["tip"], alone)
        # Another scale is another mesh.
        Path("mine.msh").write_text(sling.read_text())
        self.caught_in_sweep(scene, {"/mesh/scale": [1e-3, 2e-3]}, 1, folder="b",
                             measure=lambda sim: {"width": np.ptp(sim.rest[:, 0])})
        np.testing.assert_allclose(suture.read_results("b")["width"], [0.9, 1.8])
        # A mesh that is missing fails run by run.
        Path("mine.msh").unlink()
        failed = suture.sweep(scene, values, 1, measure=tip, folder="c")
        self.assertIn("there is no file", failed.rows[2]["error"])

    def test_finished_runs_are_not_repeated(self):
        made = []

        def report(done, every):
            made.append((done, every))

        suture.sweep(bar(), {E: [1e5, 2e5]}, 1, measure=tip, report=report)
        suture.sweep(bar(), {E: [1e5, 2e5, 3e5]}, 1, measure=tip, report=report)
        self.assertEqual(made, [(1, 2), (2, 2), (1, 1)])
        suture.sweep(bar(end=0.01), {E: [1e5]}, 1, measure=tip, report=report)
        self.assertEqual(made[3:], [(1, 1)])  # another scene
        suture.sweep(bar(end=0.01), {E: [1e5]}, 1, measure=lambda sim: tip(sim), report=report)
        self.assertEqual(made[4:], [(1, 1)])  # another function
        suture.sweep(bar(end=0.01), {E: [1e5]}, 1, measure=lambda sim: tip(sim), report=report)
        self.assertEqual(made[5:], [])

    def test_failed_runs_are_rows_too(self):
        results = suture.sweep(bar(), {"/solver/dt": [1e-4, -1, 1e-5]}, 2,
                               measure=lambda sim: {"t": sim.step() and sim.time})
        self.assertEqual([row["outcome"] for row in results.rows],
                         ["stopped", "failed", "stopped"])
        self.assertIn("must be > 0 s", results.rows[1]["error"])
        np.testing.assert_allclose(results["t"][[0, 2]], [1e-4, 1e-5])

    def test_a_function_that_fails_is_called_again(self):
        def measure(sim):
            if sim.position[:, 0].max() > 2:
                raise KeyError("mine")
            return {}

        with open(os.devnull, "w") as nowhere:  # the traceback of the process
            saved = os.dup(2)
            os.dup2(nowhere.fileno(), 2)
            try:
                results = suture.sweep(bar(), [{E: 1e5}], measure=measure)
            finally:
                os.dup2(saved, 2)
                os.close(saved)
        self.assertEqual(results.rows[0]["error"], "KeyError: 'mine'")
        self.assertNotIn("again", results.columns)

        def measure(sim):  # noqa: F811: mended
            return {"x": 5}

        self.assertEqual(suture.sweep(bar(), [{E: 1e5}], measure=measure)["x"], [5])

    def test_a_process_that_dies_is_repeated_next_time(self):
        def fragile(sim):
            if not os.path.exists("../born"):
                os._exit(9)
            return {"x": 1}

        results = suture.sweep(bar(), {E: [1e5]}, measure=fragile)
        self.assertEqual(results.rows[0]["error"], "the process ended early")
        Path("born").touch()
        os.makedirs("sweep", exist_ok=True)
        self.assertEqual(suture.sweep(bar(), {E: [1e5]}, measure=fragile)["x"], [1])

    def test_control_c_within_a_fork_is_not_lost(self):
        comes = [True]
        os.register_at_fork(after_in_parent=lambda: comes and signal.raise_signal(signal.SIGINT))
        try:
            with self.assertRaises(KeyboardInterrupt):
                suture.sweep(bar(), {E: [1e5, 2e5]}, 1, measure=tip)
        finally:
            comes.clear()
        self.assertEqual(len(suture.sweep(bar(), {E: [1e5, 2e5]}, 1, measure=tip)), 2)


class CommandLine(InFolder):
    def sweep(self, *words, **options):
        return subprocess.run([os.environ["SUTURE_PROGRAM"], "sweep", *words], text=True,
                              capture_output=True, **options)

    def study(self, **more):
        scene = bar((2, 1, 1), output={"probes": {"every_steps": 50, "at": [
            {"name": "tip", "point": [3, 1, 1], "fields": ["displacement"]}]}})
        Path("bar.json").write_text(json.dumps(scene))
        study = {"scene": "bar.json", "folder": "out", "grid": {E: [1e5, 2e5]}, **more}
        Path("study.json").write_text(json.dumps(
            {key: value for key, value in study.items() if value is not None}))

    def test_a_study(self):
        self.study()
        done = self.sweep("study.json", "--jobs", "2")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("2 runs, 0 failed", done.stdout)
        with open("out/results.csv") as table:
            rows = list(csv.DictReader(table))
        found = [float(row["tip displacement y [m]"]) for row in rows]
        sims = [suture.Simulation("bar.json", {E: e}) for e in (1e5, 2e5)]
        for sim, value in zip(sims, found):
            sim.run()
            corner = np.argmax(sim.rest.sum(axis=1))
            self.assertEqual(value, (sim.position - sim.rest)[corner, 1])
        # The series of all runs, in one table and one by one.
        with open("out/probes.csv") as table:
            rows = list(csv.DictReader(table))
        name = "tip displacement y [m]"
        results = suture.read_results("out")
        self.assertEqual(results.parameters, [E])
        series = results.series(name)
        self.assertEqual(len(series), 2)
        for run, (times, values) in enumerate(series):
            mine = [row for row in rows if row["run"] == str(run)]
            self.assertEqual([float(row["time [s]"]) for row in mine], list(times))
            self.assertEqual([float(row[name]) for row in mine], list(values))
            self.assertEqual(values[-1], results[name][run])
        self.assertGreater(len(times), 3)
        with self.assertRaisesRegex(KeyError, "no run has a series 'top'; there are tip"):
            results.series("top")
        for words in (["out"], ["study.json"], ["out", "--only", "y [m]"]):
            drawn = subprocess.run([os.environ["SUTURE_PROGRAM"], "plot", *words], text=True,
                                   capture_output=True)
            self.assertEqual((drawn.returncode, drawn.stderr), (0, ""))
        titles = [axes.get_title() for axes in results.plot(["y [m]"]).axes if axes.get_title()]
        self.assertEqual(titles, [name + " at the end", name])

    def test_a_table_of_another_scene_does_not_stay(self):
        self.study()
        self.sweep("study.json")
        scene = json.loads(Path("bar.json").read_text())
        Path("bar.json").write_text(json.dumps({**scene, "output": {"energies": {}}}))
        self.assertEqual(self.sweep("study.json").returncode, 0)
        self.assertFalse(Path("out/probes.csv").exists())
        self.assertNotIn("tip displacement y [m]", suture.read_results("out").series_columns)
        self.study(output=False)
        self.assertEqual(self.sweep("study.json").returncode, 0)
        self.assertEqual(suture.read_results("out").series_columns, [])

    def test_failures_of_one_kind_are_one_line(self):
        self.study(grid={E: [-1, -2, -3, 1e5]})
        done = self.sweep("study.json")
        self.assertEqual(done.returncode, 5)
        self.assertEqual(len(done.stdout.splitlines()), 2, done.stdout)
        self.assertIn("(run 0, and 2 more)", done.stdout)

    def test_a_job_script_makes_the_same_study(self):
        self.study()
        done = self.sweep("study.json", "--slurm", "job.sh")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertFalse(os.path.exists("out"))
        self.assertIn("--array=0-1", Path("job.sh").read_text())
        Path("json.py").write_text("raise ImportError('a file of the working folder')")
        for number in "01":
            environment = {**os.environ, "SLURM_ARRAY_TASK_ID": number}
            subprocess.run(["bash", "job.sh"], check=True, env=environment)
        written = os.stat("out/runs/0001/result.json").st_mtime_ns
        self.assertEqual(self.sweep("study.json").returncode, 0)
        self.assertEqual(os.stat("out/runs/0001/result.json").st_mtime_ns, written)
        self.assertTrue(os.path.exists("out/results.csv"))

    def test_mistakes(self):
        cases = [
            (dict(gird={}), "unknown key 'gird'"),
            (dict(grid=None), "exactly one of 'grid', 'list'"),
            (dict(grid={"E": [1]}), "/grid: .*JSON pointer"),
            (dict(grid=None, latin_hypercube={"ranges": {E: [1, 2]}}), "/latin_hypercube: .*runs"),
            (dict(scene=None), "'scene' is missing"),
            (dict(scene="nowhere.json"), "nowhere.json"),
        ]
        for more, text in cases:
            with self.subTest(text):
                self.study(**more)
                done = self.sweep("study.json")
                self.assertNotEqual(done.returncode, 0)
                self.assertRegex(done.stderr, text)
                self.assertNotIn("Traceback", done.stderr)
        self.study(grid={E: [-1]})
        done = self.sweep("study.json")
        self.assertEqual(done.returncode, 5)
        self.assertIn("1 run, 1 failed", done.stdout)

    def test_values_of_a_wrong_type_are_mistakes_of_the_study(self):
        cube = {"ranges": {E: [1e5, 2e5]}, "runs": 2}
        cases = [
            (dict(folder=3), "study.json: /folder: must be the name of a folder, is 3"),
            (dict(scene=3), "/scene: must be the path of a scene"),
            (dict(set=-1), "/set: must be an object"),
            (dict(set={"E": 1}), "/set: 'E' must be a JSON pointer"),
            (dict(jobs="x"), "/jobs: must be a whole number >= 1, is \"x\""),
            (dict(jobs=-1), "/jobs: must be a whole number >= 1, is -1"),
            (dict(output="yes"), "/output: must be true or false"),
            (dict(grid=3), "/grid: must be an object, is 3"),
            (dict(grid={E: 3}), "/grid: .* must have an array of values, has 3"),
            (dict(grid={f"/{i}": list(range(100)) for i in range(4)}),
             "/grid: the study has 100,000,000 runs; at most 1,000,000"),
            (dict(grid=None, list={}), "/list: must be an array of points"),
            (dict(grid=None, list=[{}, 4]), "/list/1: must be an object, is 4"),
            (dict(grid=None, latin_hypercube={**cube, "runs": 10**9}),
             "/latin_hypercube/runs: must be a whole number from 1 to 1,000,000"),
            (dict(grid=None, latin_hypercube={**cube, "runs": "x"}), "/runs: .* is \"x\""),
            (dict(grid=None, latin_hypercube={**cube, "seed": 0.5}), "/seed: must be a whole"),
            (dict(grid=None, latin_hypercube={**cube, "ranges": {E: [2, 1]}}), "low < high"),
            (dict(grid=None, latin_hypercube={**cube, "log": [["a"]]}), "/log: must be an array of"),
            (dict(grid=None, latin_hypercube={**cube, "log": ["/a"]}), "no range"),
            (dict(folder="../escaped"), "/folder: leads out of the folder of the study"),
            (dict(folder="/tmp/escaped"), "/folder: leads out"),
            (dict(folder="."), "/folder: leads out"),
            (dict(folder="link/out"), "/folder: leads out"),
            (dict(jbos=1), "unknown key 'jbos' \\(did you mean 'jobs'"),
        ]
        with tempfile.TemporaryDirectory() as elsewhere:
            os.symlink(elsewhere, "link")
            for more, text in cases:
                with self.subTest(text):
                    self.study(**more)
                    done = self.sweep("study.json", timeout=60)
                    self.assertEqual(done.returncode, 3, done.stderr)
                    self.assertRegex(done.stderr, text)
                    self.assertNotIn("Traceback", done.stderr)
            self.assertEqual(os.listdir(elsewhere), [])
            Path("out").mkdir()
            os.symlink(elsewhere, "out/runs")
            self.study()
            done = self.sweep("study.json")
            self.assertEqual(done.returncode, 6, done.stderr)
            self.assertIn("out/runs: is a link", done.stderr)
            self.assertEqual(os.listdir(elsewhere), [])
        for text, words in [('{"scene": NaN}', "NaN"), ("[" * 100000, "nested too deep"),
                            ('{"jobs": 1, "jobs": 2}', "'jobs' is given twice"), ("\xff", "study")]:
            Path("study.json").write_text(text, encoding="latin-1")
            done = self.sweep("study.json")
            self.assertEqual(done.returncode, 3, done.stderr)
            self.assertIn(words, done.stderr)
            self.assertNotIn("Traceback", done.stderr)

    def test_scenes_without_output_and_with_their_own_folder(self):
        for output in (False, {"directory": "/somewhere/else"}):
            with self.subTest(output):
                self.study()
                scene = json.loads(Path("bar.json").read_text())
                Path("bar.json").write_text(json.dumps({**scene, "output": output}))
                done = self.sweep("study.json")
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
                self.assertEqual(Path("out/runs/0000/run.pvd").exists(), output is not False)

    def test_control_c_and_on(self):
        self.study(set={"/solver/dt": 1e-6, "/solver/end": 0.3, "/output": False}, output=False,
                   grid={E: [1e5 + i for i in range(8)]})
        self.stop_when(lambda: list(Path(".").glob("out/runs/*/result.json")), "sweep",
                       "study.json", "--jobs", "2")
        self.assertLess(len(list(Path(".").glob("out/runs/*/result.json"))), 8)


if __name__ == "__main__":
    unittest.main()
