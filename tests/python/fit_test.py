# SPDX-License-Identifier: GPL-3.0-or-later
"""Fits of values to data that are made with known values."""

import json
import os
import re
import shutil
import subprocess
import unittest
import warnings
from pathlib import Path

import numpy as np

import in_folder
import suture
from scenes import bar

try:
    import scipy  # noqa: F401
except ImportError:
    raise unittest.SkipTest("a fit needs python3-scipy") from None

E, NU, RHO = (f"/models/0/parameters/{name}" for name in ("E", "nu", "rho"))
DOCS = Path(__file__).parents[2] / "docs" / "fits"
TRUE = {E: 1.3e5, NU: 0.25}
RANGES = {E: {"range": [1e4, 1e6], "log": True}, NU: {"range": [0.05, 0.45]}}
PROBES = {"probes": {"at": [
    {"name": "grip", "where": {"set": "x1"}, "fields": ["reaction"]},
    {"name": "side", "point": [1.5, 1, 0.5], "fields": ["displacement"]}]}}
COLUMNS = {"grip reaction x": "force", "side displacement y": "side"}


def moved(translation, frames=4, model="tm-faure", **more):
    """A bar whose end is moved, through equilibria."""
    return bar(model=model, gravity=[0, 0, 0], output=PROBES,
               constraints=[{"fix": "xyz", "where": {"set": "x0"}},
                            {"move": {"translation": translation}, "ramp": 1,
                             "where": {"set": "x1"}}],
               solver={"static": {"frames": frames}, "end": 1, "threads": 1}, **more)


def curve_of(scene, values, noise=0.0, seed=0):
    """What the probes give with these values, as data."""
    sim = suture.Simulation(scene, values)
    rows = []
    while sim.step():
        probes = sim.probes()
        rows.append([sim.time, probes["grip"]["reaction"][0], probes["side"]["displacement"][1]])
    times, force, side = np.array(rows).T
    random = np.random.default_rng(seed)
    for values in (force, side):
        values += noise * abs(values).max() * random.normal(size=len(times))
    return {"time": times, "force": force, "side": side}


def test_of(scene, values=None, /, **more):
    return {"curve": curve_of(scene, values or TRUE), "columns": COLUMNS, **more}


class InFolder(in_folder.InFolder):
    def suture(self, *words, **more):
        return subprocess.run([os.environ["SUTURE_PROGRAM"], *words], capture_output=True,
                              text=True, timeout=300, **more)


class Values(unittest.TestCase):
    def assert_true_values(self, result, within=1e-3):
        for pointer, value in result.values.items():
            self.assertLess(abs(value / TRUE[pointer] - 1), within, result)

    def test_two_values_from_a_curve(self):
        pulled = moved([0.4, 0, 0])
        for jobs in (1, 2):
            result = suture.fit(pulled, RANGES, [test_of(pulled)], jobs=jobs)
            self.assertEqual(result.outcome, "converged")
            self.assertLessEqual(result.evaluations, 8)
            self.assert_true_values(result)
            self.assertEqual(result.notes, {})

    def test_errors_are_those_of_the_noise(self):
        pulled = moved([0.4, 0, 0], 8)
        exact = curve_of(pulled, TRUE)
        deviation = {label: 0.02 * abs(exact[name]).max() for label, name in COLUMNS.items()}
        misses, chi2 = [], []
        for seed in range(12):
            result = suture.fit(pulled, RANGES, [
                {"curve": curve_of(pulled, TRUE, 0.02, seed), "columns": COLUMNS,
                 "deviation": deviation}], jobs=1)
            misses.append([(result.values[key] - TRUE[key]) / result.errors[key] for key in TRUE])
            chi2.append(result.chi2)
        self.assertTrue(0.5 < np.std(misses) < 1.6, np.std(misses))
        self.assertTrue(9 < np.mean(chi2) < 20, np.mean(chi2))  # 16 values, 2 numbers

    def test_several_tests_at_once(self):
        scenes = moved([0.4, 0, 0]), moved([0, 0.4, 0])
        tests = [test_of(scenes[0], name="tension"),
                 test_of(scenes[1], name="shear", scene=scenes[1])]
        result = suture.fit(scenes[0], RANGES, tests)
        self.assert_true_values(result)
        self.assertEqual([test["name"] for test in result.tests], ["tension", "shear"])

    def test_data_between_the_equilibria_are_interpolated(self):
        pulled = moved([0.01, 0, 0])  # nearly linear
        data = curve_of(pulled, TRUE)
        times = np.array([0.1, 0.4, 0.6, 0.9])
        between = {"time": times, **{name: np.interp(times, [0, *data["time"]], [0, *data[name]])
                                     for name in ("force", "side")}}
        result = suture.fit(pulled, RANGES, [{"curve": between, "columns": COLUMNS}], jobs=1)
        self.assert_true_values(result)

    def test_regions(self):
        left = {"box": {"min": [0, 0, 0], "max": [1.5, 1, 1]}}
        table = {"regions": [{"region": left, "value": 1e5}], "elsewhere": 2e5}
        parameters = {"E": table, "nu": 0.3, "rho": 1000}
        pulled = moved([0.4, 0.2, 0], models=[{"model": "tm-faure", "parameters": parameters}])
        truth = {E: {"regions": [{"region": left, "value": 3e5}], "elsewhere": 5e4}}
        result = suture.fit(pulled, {E: {**RANGES[E], "per": "region"}}, [test_of(pulled, truth)],
                            jobs=1)
        np.testing.assert_allclose(result.values[E], [3e5, 5e4], rtol=1e-3)

    def test_motions(self):
        """Runs of implicit Euler have derivatives; those of other schemes are differences."""
        for integrator in ("implicit-euler", "newmark"):
            sagging = bar(output=PROBES, solver={"integrator": integrator, "dt": 0.02, "end": 0.4,
                                                 "threads": 1})
            data = curve_of(sagging, {E: TRUE[E]})
            with warnings.catch_warnings(record=True) as caught:
                warnings.simplefilter("always")
                result = suture.fit(sagging, {E: RANGES[E]}, [
                    {"curve": data, "columns": {"side displacement y": "side"}}])
            said = " ".join(str(w.message) for w in caught)
            self.assertEqual("differences of whole runs" in said, integrator == "newmark", said)
            self.assert_true_values(result)

    def test_loads_and_motions_of_the_scene(self):
        """Of equilibria and of a motion; their derivatives follow the run."""
        way, pull = "/constraints/1/move/translation/0", "/loads/0/traction/1"
        load = {"traction": [0, 1e3, 0], "where": {"box": {"min": [1, 1, 0], "max": [2.25, 1, 1]}}}
        motion = {"integrator": "implicit-euler", "dt": 0.1, "end": 1, "threads": 1}
        truth = {**TRUE, way: 0.4, pull: 2e3}
        pulled = moved([0.3, 0, 0], loads=[load])
        for scene in (pulled, {**pulled, "solver": motion}):
            with warnings.catch_warnings(record=True) as caught:
                warnings.simplefilter("always")
                result = suture.fit(scene, {way: {"range": [0.1, 0.8]},
                                            pull: {"range": [-1e4, 1e4]}},
                                    [test_of(scene, truth)], set=TRUE)
            self.assertNotIn("differences", " ".join(str(w.message) for w in caught))
            self.assertLessEqual(result.evaluations, 8)
            for pointer in (way, pull):
                self.assertLess(abs(result.values[pointer] / truth[pointer] - 1), 1e-3, result)

    def test_other_values_of_the_scene(self):
        sagging = bar(output=PROBES, gravity=[0, -1, 0], solver={
            "integrator": "implicit-euler", "dt": 0.1, "end": 1, "threads": 1, "damping": 1})
        pointer = "/solver/damping"
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            result = suture.fit(sagging, {pointer: {"range": [0.1, 8], "start": 3}},
                                [test_of(sagging)], set=TRUE)
        self.assertIn("no number of a load or a motion", " ".join(str(w.message) for w in caught))
        self.assertAlmostEqual(result.values[pointer], 1, 3)

    def test_an_outlier_and_a_loss(self):
        pulled = moved([0.4, 0, 0], 10)
        data = test_of(pulled, deviation={"grip reaction x": 20, "side displacement y": 1e-4})
        data["curve"]["force"][6] *= 1.5
        value = {loss: suture.fit(pulled, {E: RANGES[E]}, [data], set={NU: TRUE[NU]}, loss=loss,
                                  jobs=1).values[E] for loss in ("linear", "soft_l1")}
        self.assertGreater(abs(value["linear"] / TRUE[E] - 1), 0.03)
        self.assertLess(abs(value["soft_l1"] / TRUE[E] - 1), 0.005)

    def test_a_word_where_a_value_is_open(self):
        pulled = moved([0.4, 0, 0])
        data = {"curve": curve_of(pulled, TRUE), "columns": {"grip reaction x": "force"},
                "deviation": 1e4}
        result = suture.fit(pulled, RANGES, [data], jobs=1)
        self.assertIn("not identifiable", result.notes["nu"])
        self.assertIn("not identifiable", "\n".join(result.summary()))

    def test_points(self):
        twisted = moved([0.3, 0.3, 0], 2)
        sim = suture.Simulation(twisted, TRUE)
        sim.run()
        columns = {c: sim.rest[:, i] for i, c in enumerate("xyz")}
        markers = {**columns, "ux": (sim.position - sim.rest)[:, 0],
                   "uy": (sim.position - sim.rest)[:, 1]}
        result = suture.fit(twisted, {NU: RANGES[NU]}, [{"points": markers}], jobs=1)
        self.assert_true_values(result)
        scan = {c: sim.surface().points[::2, i] for i, c in enumerate("xyz")}
        result = suture.fit(twisted, {NU: RANGES[NU]}, [{"points": scan, "time": 1}], jobs=1)
        self.assert_true_values(result, 0.02)
        self.assertEqual(result.count, len(scan["x"]))

    def test_measured_points_inside_elements(self):
        bent = moved([0.3, 0.3, 0], 1)
        sim = suture.Simulation(bent, TRUE)
        sim.run()
        middle = sim.rest[sim._hexahedra()].mean(axis=1)
        shift = (sim.position - sim.rest)[sim._hexahedra()].mean(axis=1)
        data = {**{c: middle[:, i] for i, c in enumerate("xyz")}, "uz": shift[:, 2]}
        result = suture.fit(bent, {NU: RANGES[NU]}, [{"points": data}], jobs=1)
        self.assert_true_values(result)


class Fields(unittest.TestCase):
    """A block whose upper part is stiff, with what its surface shows of two loads."""

    def block(self, traction, cells=(6, 6, 4)):
        return bar(mesh={"box": {"size": [0.3, 0.3, 0.2], "cells": list(cells)}},
                   gravity=[0, 0, 0], constraints=[{"fix": "xyz", "where": {"set": "z0"}}],
                   loads=[{"traction": traction, "where": {"set": "z1"}}],
                   solver={"static": {"frames": 1}, "threads": 1})

    def stiff(self, places):
        return (places[:, 2] > 0.1) & (places[:, 0] < 0.15)

    def data(self, noise=0.002):
        random, data = np.random.default_rng(2), []
        for traction in ([0, 0, 3000], [1500, 0, 0]):
            sim = suture.Simulation(self.block(traction, (12, 12, 8)))
            mesh = sim.mesh()
            moduli = np.where(self.stiff(mesh.points[mesh.hexahedra].mean(axis=1)), 4e5, 1e5)
            sim.parameters["tm-faure"]["E"] = moduli
            sim.run()
            rows = np.unique(sim.surface().vertices)
            rows = rows[sim.rest[rows, 2] > 0.01]
            moved = (sim.position - sim.rest)[rows]
            deviation = noise * abs(moved).max()
            moved += deviation * random.normal(size=moved.shape)
            data.append({"scene": self.block(traction), "deviation": deviation, "points": {
                **{c: sim.rest[rows, i] for i, c in enumerate("xyz")},
                **{"u" + c: moved[:, i] for i, c in enumerate("xyz")}}})
        return data

    def field(self, **more):
        return {"range": [2e4, 2e6], "log": True, "per": "element", **more}

    def test_an_inclusion_is_found(self):
        result = suture.fit(self.block([0, 0, 0]), {E: self.field(regularise={"tv": 20})},
                            self.data(), stop={"evaluations": 120})
        found = result.values[E]
        mesh = result.fields[E]
        stiff = self.stiff(mesh["points"][mesh["hexahedra"]].mean(axis=1))
        self.assertGreater(np.mean((found > 2e5) == stiff), 0.95)
        self.assertLess(abs(np.median(found[stiff]) / 4e5 - 1), 0.2)
        self.assertLess(abs(np.median(found[~stiff]) / 1e5 - 1), 0.1)
        self.assertEqual(sorted(mesh["ids"]), list(range(144)))

    def test_the_gradient_is_that_of_what_is_minimised(self):
        from suture._fit import _prepare
        from suture._fit_evaluation import Record
        from suture._fit_field import _Objective
        from suture._fit_file import problem_of
        from suture._fit_values import Derivatives

        for loss, kind in (("linear", "tv"), ("soft_l1", "tikhonov"), ("huber", "tv"),
                           ("cauchy", "tv")):
            problem = problem_of({"scene": self.block([0, 0, 0]), "loss": loss, "fit": {
                E: self.field(regularise={kind: 5}), NU: RANGES[NU]}, "data": self.data()}, Path())
            _prepare(problem)
            sim = suture.Simulation(problem.tests[0].scene)
            objective = _Objective(problem, Derivatives(problem, 1, False),
                                   Record(problem), sim)
            random = np.random.default_rng(3)
            q = random.uniform(0.3, 0.7, problem.unknowns.size)
            direction = random.normal(size=len(q))
            _, gradient = objective(q)
            h = 1e-4
            ends = [objective(q + k * h * direction)[0] for k in (-2, -1, 1, 2)]
            expected = (8 * (ends[2] - ends[1]) - (ends[3] - ends[0])) / (12 * h)
            self.assertLess(abs(gradient @ direction / expected - 1), 1e-4, (loss, kind))

    def test_penalties_keep_their_size_on_finer_meshes(self):
        from suture._fit_field import Neighbours

        found = []
        for n in (1, 2):
            sim = suture.Simulation(self.block([0, 0, 0], (6 * n, 6 * n, 4 * n)))
            centres = sim.rest[sim._hexahedra()].mean(axis=1)
            neighbours = Neighbours(sim, 0)
            found.append((neighbours.penalty("tv", np.where(centres[:, 2] > 0.1, 5.0, 2.0))[0],
                          neighbours.penalty("tikhonov", 7 * centres[:, 0])[0]))
        volume = 0.3 * 0.3 * 0.2
        self.assertAlmostEqual(found[0][0] / (0.09 * (3 - 0.02) / volume ** (2 / 3)), 1, 2)
        self.assertAlmostEqual(found[1][0], found[0][0], 9)
        # 7^2 V / 2 over the cube root of V, but for half an element at both ends
        self.assertAlmostEqual(found[0][1] / (24.5 * volume ** (2 / 3)), 5 / 6, 6)
        self.assertAlmostEqual(found[1][1] / (24.5 * volume ** (2 / 3)), 11 / 12, 6)

    def test_what_fields_refuse(self):
        test = self.data()[0]
        moving = {**self.block([0, 0, 0]), "solver": {"dt": 1e-4, "end": 1e-3, "threads": 1}}
        for parameters, scene, text in (
                ({E: self.field(regularise={"tv": 0})}, None, "regularise: must be"),
                ({E: {**self.field(), "per": "value", "regularise": {"tv": 1}}}, None,
                 "only what is fitted per \"element\" is regularised"),
                ({"/loads/0/traction/0": self.field()}, None, "is not a parameter of a model"),
                ({E: self.field(), "/gravity/0": {"range": [0, 1]}}, None, "only parameters of"),
                ({RHO: {**self.field(), "range": [500, 2000]}}, None, "rho has no effect"),
                ({E: self.field()}, moving, "a field needs derivatives")):
            with self.subTest(text):
                data = [{**test, **({"scene": scene} if scene else {})}]
                with self.assertRaisesRegex(ValueError, text):
                    suture.fit(self.block([0, 0, 0]), parameters, data)


class Mistakes(unittest.TestCase):
    def test_each_has_one_clear_message(self):
        pulled = moved([0.4, 0, 0])
        good = test_of(pulled)
        late = {**good, "curve": {**good["curve"], "time": good["curve"]["time"] + [0, 0, 0, 1]}}
        early = {**good, "curve": {**good["curve"], "time": good["curve"]["time"] - 1}}
        outside = {"points": {"x": [0.0, 9.0], "y": [0.0, 0], "z": [0.0, 0], "ux": [0.0, 1]}}
        heavy = moved([0, 0, 0])
        heavy["gravity"] = [-100, 0, 0]
        cases = [
            (RANGES, [late],
             "row 3: the time 2 s lies outside of the run, which goes from 0 to 1 s"),
            (RANGES, [early], "/data/0: row 0: the time .* before the start"),
            (RANGES, [{**good, "columns": {"grip reaction x": "forse"}}],
             "no column 'forse'; did you mean 'force'"),
            (RANGES, [{**good, "columns": {"grip reaction w": "force"}}], "PROBE reaction x"),
            (RANGES, [{**good, "columns": {"gripp reaction x": "force"}}], "gripp"),
            ({RHO: {"range": [500, 2000]}}, [good], "rho has no effect on the data of any test"),
            ({"/models/0/parameters/F": {"range": [1, 2]}}, [good], "no parameter 'F'"),
            ({"/models/3/parameters/E": {"range": [1, 2]}}, [good],
             "/fit: .* the scene has no model 3"),
            ({NU: {"range": [0.1, 0.7]}}, [good], "range of '.*nu' contains 0.7, which the scene"),
            ({E: {"range": [2, 1]}}, [good], "low < high"),
            ({E: {"range": [-1, 1], "log": True}}, [good], "range must be > 0"),
            ({E: {"range": [1e4, 1e5], "start": 1e6}}, [good], "starts at 1e\\+06, outside"),
            ({E: {"range": [1e4, 1e5], "per": "region"}}, [good], "1 different values"),
            (RANGES, [good, {**good, "deviation": 1.0}], "/data/0: 'deviation' is missing"),
            (RANGES, [{**good, "deviation": {"grip reaction y": 1.0}}], "'grip reaction y'"),
            (RANGES, [{**good, "points": {}}], "exactly one of 'curve' and 'points'"),
            ({NU: RANGES[NU]}, [outside], "row 1: the point .* lies .* outside of the body"),
            ({E: {"range": [1, 10], "log": True}}, [{**good, "scene": heavy}],
             "exclude every stable body"),
        ]
        for parameters, data, text in cases:
            with self.subTest(text):
                with warnings.catch_warnings():
                    warnings.simplefilter("ignore")
                    with self.assertRaisesRegex((ValueError, suture.Error), text) as caught:
                        suture.fit(pulled, parameters, data)
                self.assertNotIn("\n", str(caught.exception).strip())


class Program(InFolder):
    def study(self, **more):
        shutil.copytree(DOCS, ".", dirs_exist_ok=True)
        study = json.loads(Path("tension-fit.json").read_text())
        Path("study.json").write_text(json.dumps({**study, **more}))

    def test_the_documentation_shows_the_studies(self):
        text = (DOCS.parent / "fit.md").read_text()
        shown = [json.loads(part) for part in re.findall(r"```json\n(.*?)```", text, re.S)]
        files = [json.loads(file.read_text()) for file in DOCS.glob("*-fit.json")]
        for study in shown:
            self.assertIn(study, [{key: value for key, value in file.items() if key != "stop"}
                                  for file in files])
        self.assertEqual(len(shown), 2)

    def test_the_study_of_the_documentation(self):
        self.study(folder="out")
        done = self.suture("fit", "study.json")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("converged", done.stdout)
        result = suture.read_fit_result("out")
        for pointer, value in ((E, 3.1e4), (NU, 0.44)):
            self.assertLess(abs(result.values[pointer] - value), 4 * result.errors[pointer])
        self.assertLess(abs(result.chi2 - 40), 30)
        for name in ("values.csv", "data.csv", "fit.png"):
            self.assertTrue(Path("out", name).exists(), name)
        changed = Path("out/fit.json").stat().st_mtime_ns
        again = self.suture("fit", "study.json")
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertNotIn("evaluation 1", again.stderr)  # it has been made
        self.assertEqual(Path("out/fit.json").stat().st_mtime_ns, changed)

    def test_a_model_with_a_memory_at_three_rates(self):
        self.study()
        done = self.suture("fit", "liver-fit.json")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertNotIn("differences", done.stderr)  # the run has derivatives
        result = suture.read_fit_result("liver-fit")
        self.assertLess(abs(result.values["/models/0/parameters/K"] / 861 - 1), 0.03)
        self.assertLess(abs(result.values["/models/0/parameters/n"] - 0.1138), 0.02)
        self.assertLess(result.chi2, 1)

    def test_the_field_of_the_documentation(self):
        self.study()
        study = json.loads(Path("block-fit.json").read_text())
        study["stop"] = {"evaluations": 15}
        Path("study.json").write_text(json.dumps({**study, "folder": "out"}))
        done = self.suture("fit", "study.json")
        self.assertIn(done.returncode, (0, 5), done.stderr)
        result = suture.read_fit_result("out")
        field = next(iter(result.fields.values()))
        centres = field["points"][field["hexahedra"]].mean(axis=1)
        ball = np.linalg.norm(centres - [0.03, 0.05, 0.03], axis=1) < 0.02
        soft = (abs(centres - [0.07, 0.05, 0.035]) < [0.015, 0.015, 0.01]).all(axis=1)
        found = result.values[E] / 1e4
        kind = np.digitize(np.log(found), np.log([0.4, 3]) / 2)
        self.assertGreater(np.mean(kind == 1 + ball - soft), 0.95)
        self.assertLess(result.chi2, 1.2 * result.count)
        self.assertTrue(Path("out/E.vtu").exists())

    def test_a_fit_goes_on_where_it_was_stopped(self):
        self.study(folder="out", stop={"evaluations": 2})
        done = self.suture("fit", "study.json")
        self.assertEqual(done.returncode, 5, done.stderr)
        self.assertIn("stopped after 2 evaluations", done.stdout)
        before = suture.read_fit_result("out").chi2
        self.study(folder="out")
        done = self.suture("fit", "study.json")
        self.assertEqual(done.returncode, 0, done.stderr)
        history = suture.read_fit_result("out").history
        self.assertAlmostEqual(history[0] / before, 1, 3)
        self.assertLessEqual(len(history), 6)

    def test_control_c_and_on(self):
        self.study(folder="out", set={"/mesh/box/cells": [24, 6, 6]})
        self.stop_when(Path("out/fit-state.json").exists, "fit", "study.json")

    def test_mistakes_of_the_file(self):
        curve = json.loads((DOCS / "tension-fit.json").read_text())["data"][0]
        cases = [({"sceen": 1}, "unknown key 'sceen' \\(did you mean 'scene'"),
                 ({"data": []}, "/data: must be an array of tests"),
                 ({"data": [{**curve, "curve": "no.csv"}]}, "no.csv"),
                 ({"data": [{**curve, "time": "tiem"}]}, "no column 'tiem'; did you mean 'time'"),
                 ({"fit": {}}, "/fit: must be an object"),
                 ({"fit": {E: {"rnage": [1, 2]}}}, "did you mean 'range'"),
                 ({"loss": "l1"}, "/loss: must be linear, soft_l1"),
                 ({"stop": {"evaluations": 0}}, "/stop/evaluations: must be a whole number >= 1"),
                 ({"folder": "../out"}, "leads out of the folder")]
        for more, text in cases:
            with self.subTest(text):
                self.study(**more)
                done = self.suture("fit", "study.json")
                self.assertIn(done.returncode, (3, 6), done.stderr)
                self.assertRegex(done.stderr, text)
                self.assertNotIn("Traceback", done.stderr)
        for table, text in (("time [s],force [N]\n1,2\n", "no column 'side'"),
                            ("time [s],force [kg],side [mm]\n1,2,3\n", "unit 'kg'"),
                            ("time [s],force,side [mm]\n1,2,3\n", "no unit; write it as"),
                            ("time [s],force [N],side [mm]\n1,x,3\n", ":2: column .* 'x'"),
                            ("time [s],force [N],side [mm]\n1,2\n", ":2: has 2 cells"),
                            ("time [s],force [N],side [mm]\n99,1,1\n", ":2: the time 99 s lies")):
            with self.subTest(text):
                self.study()
                Path("tension.csv").write_text(table)
                done = self.suture("fit", "study.json")
                self.assertEqual(done.returncode, 3, done.stderr)
                self.assertRegex(done.stderr, text)

    def test_without_scipy(self):
        self.study()
        Path("none").mkdir()
        Path("none/scipy.py").write_text("raise ImportError('none')")
        done = self.suture("fit", "study.json", env={**os.environ, "PYTHONPATH": "none"})
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn("a fit needs SciPy; install python3-scipy", done.stderr)


if __name__ == "__main__":
    unittest.main()
