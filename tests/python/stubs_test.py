"""The type stub states the names and signatures of the module, neither more nor less.

pybind11 writes a function's signature into the first lines of its docstring; the stub is read as a syntax tree.
"""

import ast
import inspect
import pathlib
import re
import unittest

import foci

STUB = ast.parse(pathlib.Path(foci.__file__).with_name("__init__.pyi").read_text())
# Keywords of the event detection, which the module takes as **settings, each with a value that it takes.
SETTINGS = {"online": False, "detector": "rules", "pursuit": None, "saccade_deg_s": 30.0, "min_fixation_s": 0.05,
            "max_blink_s": 0.5, "delay_s": 0.0}
UNSTATED = "..."


def value_of(text):
    """A literal, or `...` for one that the stub need not repeat: a container or another type's object."""
    try:
        value = ast.literal_eval(text)
    except (SyntaxError, ValueError):
        return UNSTATED
    return UNSTATED if isinstance(value, (tuple, list)) or value is ... else value


def stub_parameters(function):
    """(name, keyword only, default) of each parameter but self; the default is None for a parameter without one."""
    arguments = function.args
    plain = arguments.args
    defaults = [None] * (len(plain) - len(arguments.defaults)) + arguments.defaults
    rows = [(a, False, d) for a, d in zip(plain, defaults) if a.arg != "self"]
    rows += [(a, True, d) for a, d in zip(arguments.kwonlyargs, arguments.kw_defaults)]
    return [(a.arg, only, d and (value_of(ast.unparse(d)),)) for a, only, d in rows]


def split(text):
    """At the commas outside of brackets."""
    parts, depth = [""], 0
    for letter in text.replace("->", "  "):
        depth += (letter in "([{<") - (letter in ")]}>")
        if letter == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += letter
    return [part.strip() for part in parts if part.strip()]


def documented_parameters(docstring, name):
    """The overloads, in order, as stub_parameters gives them."""
    overloads = []
    for signature in re.findall(rf"^(?:\d+\. )?{name}\((.*)\) -> ", docstring, re.M):
        if signature == "*args, **kwargs":
            continue
        rows, only = [], False
        for part in split(signature):
            if part == "*":
                only = True
            elif part == "**kwargs":
                rows += [(key, True, (UNSTATED,)) for key in SETTINGS]
            elif not part.startswith("self: "):
                declared, _, default = part.partition(" = ")
                rows.append((declared.split(":")[0], only, (value_of(default),) if default else None))
        overloads.append(rows)
    return overloads


def python_parameters(function):
    rows = []
    for each in inspect.signature(function).parameters.values():
        if each.kind is each.VAR_KEYWORD:
            rows += [(key, True, (UNSTATED,)) for key in SETTINGS]
        elif each.name != "self":
            default = None if each.default is each.empty else (value_of(repr(each.default)),)
            rows.append((each.name, each.kind is each.KEYWORD_ONLY, default))
    return rows


class StubsTest(unittest.TestCase):
    def assert_equal_signatures(self, name, stubs, function):
        stated = [stub_parameters(stub) for stub in stubs]
        if inspect.isfunction(function):
            actual = [python_parameters(function)]
        else:
            actual = documented_parameters(function.__doc__, function.__name__)
        self.assertEqual(len(stated), len(actual), name)
        for one, other in zip(stated, actual):
            self.assertEqual([row[:2] for row in one], [row[:2] for row in other], name)
            for (parameter, _, default), (_, _, real) in zip(one, other):
                self.assertEqual(default is None, real is None, f"{name}, {parameter}: default")
                if default and default != (UNSTATED,):
                    self.assertEqual(default, real, f"{name}, {parameter}")

    def assert_equal_members(self, stub, thing):
        functions, properties = {}, set()
        for each in stub.body:
            if isinstance(each, ast.FunctionDef):
                functions.setdefault(each.name, []).append(each)
            elif isinstance(each, ast.AnnAssign):
                self.assertRegex(ast.unparse(each.annotation), r"^Final\[", stub.name)
                properties.add(each.target.id)
        public = {name for name in vars(thing) if not name.startswith("_")}
        self.assertEqual({name for name in functions if not name.startswith("_")} | properties, public, stub.name)
        self.assertEqual(properties, {name for name in public if isinstance(vars(thing)[name], property)}, stub.name)
        for name, stubs in functions.items():
            if name not in ("__len__", "__iter__"):
                self.assert_equal_signatures(f"{stub.name}.{name}", stubs, getattr(thing, name))

    def test_every_name_is_stated_with_its_signature(self):
        stated = {node.name: node for node in STUB.body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}
        self.assertEqual(sorted(stated), sorted(foci.__all__))
        for name, stub in stated.items():
            thing = getattr(foci, name)
            if isinstance(stub, ast.FunctionDef):
                self.assert_equal_signatures(name, [stub], thing)
            elif not issubclass(thing, Exception):
                self.assert_equal_members(stub, thing)

    def test_the_module_takes_each_setting_of_the_stub_and_no_other(self):
        recording = foci.Recording([0.0, 0.1, 0.2, 0.3], [9.0, 9.0, 9.0, 9.0], [9.0, 9.0, 9.0, 9.0])
        for function in (recording.events, recording.labels, recording.quality):
            for key, value in SETTINGS.items():
                function(**{key: value})
            with self.assertRaisesRegex(TypeError, "unexpected keyword saccade"):
                function(saccade=30.0)


if __name__ == "__main__":
    unittest.main()
