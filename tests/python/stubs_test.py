# SPDX-License-Identifier: GPL-3.0-or-later
"""The type stubs and the texts of the module are true."""

import ast
import inspect
import re
import typing
import unittest
from pathlib import Path

import suture

STUB = ast.parse((Path(suture.__file__).parent / "__init__.pyi").read_text())


def public(names):
    return {name for name in names if not name.startswith("_")}


def stub_parameters(node):
    """[(name, kind, whether it has a default)] of a function in the stub, without self."""
    a = node.args
    plain = a.posonlyargs + a.args
    defaults = [False] * (len(plain) - len(a.defaults)) + [True] * len(a.defaults)
    listed = [(arg.arg, "plain", default) for arg, default in zip(plain, defaults)]
    if a.vararg:
        listed.append((a.vararg.arg, "args", False))
    listed += [(arg.arg, "keyword", default is not None)
               for arg, default in zip(a.kwonlyargs, a.kw_defaults)]
    if a.kwarg:
        listed.append((a.kwarg.arg, "kwargs", False))
    return [entry for entry in listed if entry[0] not in ("self", "cls")]


def real_parameters(function):
    """The same of the function itself; those of the compiled half are in its text."""
    kinds = {inspect.Parameter.POSITIONAL_OR_KEYWORD: "plain",
             inspect.Parameter.POSITIONAL_ONLY: "plain",
             inspect.Parameter.VAR_POSITIONAL: "args", inspect.Parameter.KEYWORD_ONLY: "keyword",
             inspect.Parameter.VAR_KEYWORD: "kwargs"}
    try:
        parameters = inspect.signature(function).parameters.values()
    except ValueError:
        inside = re.match(r"\w+\((.*)\) ->", function.__doc__).group(1)
        return [(name, "plain", bool(default))
                for name, default in re.findall(r"(\w+): [\w.:]+(?:\[.*?\])?( = )?", inside)
                if name != "self"]
    return [(p.name, kinds[p.kind], p.default is not p.empty) for p in parameters
            if p.name not in ("self", "cls")]


class Stubs(unittest.TestCase):
    def check_function(self, name, nodes, function):
        if len(nodes) == 1:  # overloads are looked at by people
            self.assertEqual(stub_parameters(nodes[0]), real_parameters(function), name)

    def check_property(self, name, nodes, real):
        self.assertIsInstance(real, property, name)
        has_setter = any(ast.unparse(d).endswith(".setter") for n in nodes for d in n.decorator_list)
        self.assertEqual(has_setter, real.fset is not None, f"{name} can be assigned")

    def check_class(self, node, real):
        functions, values = {}, set()
        for member in node.body:
            if isinstance(member, ast.FunctionDef):
                functions.setdefault(member.name, []).append(member)
            elif isinstance(member, ast.AnnAssign):
                values.add(member.target.id)
        for name, nodes in functions.items():
            where, found = f"{node.name}.{name}", inspect.getattr_static(real, name)
            if any(ast.unparse(d) == "property" for n in nodes for d in n.decorator_list):
                self.check_property(where, nodes, found)
            else:
                self.check_function(where, nodes, getattr(real, name))
        return functions.keys() | values

    def test_classes_have_the_members_of_the_stub(self):
        classes = [node for node in STUB.body if isinstance(node, ast.ClassDef)]
        for node in classes:
            with self.subTest(name=node.name):
                real = getattr(suture, node.name)
                inherited = {name for base in real.__mro__[1:] for name in vars(base)
                             if base.__module__ != "suture._suture"}
                own = public(name for name in dir(real) if name not in inherited)
                if issubclass(real, tuple):
                    own |= set(real._fields)
                stub = self.check_class(node, real)
                self.assertLessEqual(own, stub, "missing in the stub")
                self.assertEqual(public(stub) - own - self.values_of(real), set(), "not there")

    def values_of(self, real):
        """What objects get in their constructors."""
        text = inspect.getsource(real.__init__) if hasattr(real.__init__, "__code__") else ""
        return set(re.findall(r"self\.(\w+) =", text)) | {"mistakes"} & set(
            ["mistakes"] if real is suture.SceneError else [])

    def test_functions_have_the_parameters_of_the_stub(self):
        functions = [node for node in STUB.body if isinstance(node, ast.FunctionDef)]
        self.assertEqual({f.name for f in functions}, {"check_gradient", "gradient", "grid",
                                                     "latin_hypercube",
                                                     "read_results", "sweep"})
        for node in functions:
            self.check_function(node.name, [node], getattr(suture, node.name))

    def test_names(self):
        names = {node.name for node in STUB.body if hasattr(node, "name")}
        self.assertEqual(names, set(suture.__all__))
        self.assertTrue((Path(suture.__file__).parent / "py.typed").exists())

    def test_annotations_of_numbers_and_texts_are_true(self):
        from scenes import bar

        sim = suture.Simulation(bar(title="a bar"))
        sim.step(3)
        simple = {"int": int, "float": float, "str": str, "Floats": "f", "Integers": "i",
                  "Booleans": "b", "list[str]": list, "list[float]": list}
        node = next(n for n in STUB.body if getattr(n, "name", "") == "Simulation")
        checked = 0
        for member in node.body:
            decorators = [ast.unparse(d) for d in getattr(member, "decorator_list", [])]
            expected = simple.get(ast.unparse(member.returns)) if "property" in decorators else None
            if expected is None or member.name in ("contact_force", "gap"):
                continue
            value = getattr(sim, member.name)
            checked += 1
            if isinstance(expected, str):
                self.assertEqual(value.dtype.kind, expected, member.name)
            else:
                self.assertIsInstance(value, expected, member.name)
        self.assertGreater(checked, 20)


class Texts(unittest.TestCase):
    def test_everything_public_has_one(self):
        for name in public(dir(suture.Simulation)):
            text = getattr(suture.Simulation, name).__doc__
            self.assertGreater(len(text or ""), 15, name)
        for name in ("position", "velocity", "rest"):
            self.assertRegex(getattr(suture.Simulation, name).__doc__, r"\(vertices, 3\).* m")
        for name in suture.__all__:
            self.assertTrue(getattr(suture, name).__doc__, name)

    def test_tab_finds_everything(self):
        self.assertLessEqual(set(suture.__all__), set(dir(suture)))
        from scenes import bar

        self.assertIn("tm-faure", suture.Simulation(bar()).parameters._ipython_key_completions_())


if __name__ == "__main__":
    unittest.main()
