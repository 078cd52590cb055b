#!/usr/bin/python3
"""The type stubs and the docstrings name what the module has."""

import ast
import inspect
import unittest
from pathlib import Path

import clearway
from clearway._arguments import signature_of

STUB = Path(clearway.__file__).with_name("__init__.pyi")
PLAIN = {"__init__", "__len__"}  # special methods that a stub names


def public(names):
    return {name for name in names if not name.startswith("_")}


def assigned(body):
    return {node.target.id: node for node in body if isinstance(node, ast.AnnAssign)}


def value(node):
    """As repr() has it; lists as tuples, since both are taken alike."""
    found = ast.literal_eval(node)
    return repr(tuple(found) if isinstance(found, list) else found)


def parameters(function, skip=0):
    """[(name, default or None, keyword only)] of a stub's function."""
    args = function.args
    plain = args.args[skip:]
    defaults = [None] * (len(plain) - len(args.defaults)) + args.defaults + args.kw_defaults
    return [(arg.arg, default and value(default), arg in args.kwonlyargs)
            for arg, default in zip(plain + args.kwonlyargs, defaults)]


def documented(function):
    """The same of the signature that help() shows."""
    return [(p.name, None if p.default is p.empty else repr(p.default), p.kind == p.KEYWORD_ONLY)
            for p in inspect.signature(function).parameters.values()]


def checks(function):
    """The check of each parameter that the signature of the compiled function names."""
    compiled = signature_of(function.__wrapped__).parameters.values()
    return {parameter.name: parameter.annotation for parameter in compiled}


class Stubs(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.stub = ast.parse(STUB.read_text(encoding="utf-8")).body
        cls.classes = {n.name: n for n in cls.stub if isinstance(n, ast.ClassDef)}
        cls.functions = {n.name: n for n in cls.stub if isinstance(n, ast.FunctionDef)}

    def test_names_of_the_module(self):
        named = public({*self.classes, *self.functions, *assigned(self.stub)})
        self.assertEqual(named, set(clearway.__all__))
        self.assertEqual(named, public(dir(clearway._clearway)))
        self.assertTrue(STUB.with_name("py.typed").exists())
        self.assertRegex(clearway.__version__, r"^\d+\.\d+\.\d+$")

    def test_members_of_classes(self):
        for name, node in self.classes.items():
            if name.startswith("_"):
                continue
            with self.subTest(name):
                methods = {n.name for n in node.body if isinstance(n, ast.FunctionDef)}
                named = public({*methods, *assigned(node.body)}) | (methods & PLAIN)
                there = vars(getattr(clearway, name))
                has = public(there) | (set(there) & PLAIN)
                has -= {"__init__"} if "__init__" not in methods and not self.makes(name) else set()
                self.assertEqual(named, has)

    @staticmethod
    def makes(name):
        """Whether objects of the class can be made."""
        try:
            getattr(clearway, name)()
        except TypeError as error:
            return "No constructor defined" not in str(error)
        except Exception:  # an Error asks for nothing
            return False
        return not issubclass(getattr(clearway, name), Exception)

    def test_properties_are_final(self):
        for name, node in self.classes.items():
            for member, annotation in assigned(node.body).items():
                value = vars(getattr(clearway, name))[member] if not name.startswith("_") else None
                if isinstance(value, property):
                    final = ast.unparse(annotation.annotation).startswith("Final[")
                    self.assertEqual(final, value.fset is None, f"{name}.{member}")

    def test_parameters_of_functions(self):
        for name, node in self.functions.items():
            with self.subTest(name):
                self.assertEqual(documented(getattr(clearway, name)), parameters(node))

    def test_parameters_of_constructors(self):
        for name, node in self.classes.items():
            init = next((n for n in node.body if getattr(n, "name", "") == "__init__"), None)
            if init is not None:
                with self.subTest(name):
                    made = documented(getattr(clearway, name).__init__)
                    self.assertEqual(made[1:], parameters(init, skip=1))

    def test_every_member_is_documented_by_a_sentence(self):
        for name in self.classes:
            for member, value in vars(getattr(clearway, name)).items() if name[0] != "_" else ():
                if member.startswith("_") or not (callable(value) or isinstance(value, property)):
                    continue
                text = inspect.getdoc(value) or ""
                self.assertGreaterEqual(len(text.split()), 3, f"{name}.{member}: {text}")
                self.assertNotRegex(text, r"^(Of|Likewise|The same)\b", f"{name}.{member}")

    def test_every_function_is_documented_and_its_arguments_are_checked(self):
        for name in self.functions:
            text = inspect.getdoc(getattr(clearway, name))
            for parameter, check in checks(getattr(clearway, name)).items():
                self.assertTrue(callable(check), f"{name}: {parameter}")
                self.assertRegex(text, rf"(?m)\b{parameter}\b", f"{name}: {parameter}")
        for name in self.classes:
            self.assertTrue(name.startswith("_") or inspect.getdoc(getattr(clearway, name)), name)


if __name__ == "__main__":
    unittest.main()
