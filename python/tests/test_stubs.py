# SPDX-License-Identifier: BSD-3-Clause
"""The type stubs declare exactly the public names of the module."""
import ast
import importlib
import inspect
import pathlib
import re

import lidarena
import lidarena.plot

STUBS = ast.parse(pathlib.Path(lidarena.__file__).with_name("__init__.pyi").read_text())


def public(names):
    return {n for n in names if not n.startswith("_")}


def test_the_module_has_what_the_stubs_say():
    said = {node.name for node in STUBS.body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}
    said |= {node.target.id for node in STUBS.body if isinstance(node, ast.AnnAssign)}
    assert public(said) == public(dir(lidarena)) - {"external", "plot"}
    assert importlib.import_module("lidarena.external").main


def test_classes_have_what_the_stubs_say():
    classes = {node.name: node for node in STUBS.body if isinstance(node, ast.ClassDef)}
    for name, node in classes.items():
        if name in ("_Config", "Error", "InputError"):
            continue
        said = {m.name for m in node.body if isinstance(m, ast.FunctionDef)}
        said |= {m.target.id for m in node.body if isinstance(m, ast.AnnAssign)}
        if any(getattr(base, "id", "") == "_Config" for base in node.bases):
            said |= {m.name for m in classes["_Config"].body if isinstance(m, ast.FunctionDef)}
        assert public(said) - {"config"} == public(vars(getattr(lidarena, name))), name


def test_every_public_function_says_what_it_does():
    for name in public(dir(lidarena)):
        value = getattr(lidarena, name)
        if callable(value):
            assert value.__doc__, name


def declared(function):
    """Names of the parameters in a stub, with whether each has a default."""
    given = function.args
    names = [a.arg for a in given.args]
    optional = [False] * (len(names) - len(given.defaults)) + [True] * len(given.defaults)
    options = [("**" + given.kwarg.arg, False)] if given.kwarg else []
    return [pair for pair in zip(names, optional) if pair[0] != "self"] + options


def split(text):
    """A list of parameters at the commas that are not in brackets."""
    parts, depth = [""], 0
    for char in text:
        depth += (char in "[({") - (char in "])}")
        if char == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += char
    return [part.strip() for part in parts if part.strip()]


def defined(function):
    """The same of a function of the module: of Python, or of C++ from the first line of its text."""
    if inspect.isfunction(function):
        all_of = inspect.signature(function).parameters.values()
        return [("**" * (p.kind is p.VAR_KEYWORD) + p.name, p.default is not p.empty)
                for p in all_of if p.name != "self"]
    text = re.search(r"^\w+\((.*)\) ->", function.__doc__, re.M)[1]
    return [(part.split(":")[0].split("=")[0].strip(), "=" in part) for part in split(text)
            if part.split(":")[0] != "self"]


def test_functions_have_the_parameters_that_the_stubs_say():
    for node in STUBS.body:
        if isinstance(node, ast.FunctionDef):
            assert declared(node) == defined(getattr(lidarena, node.name)), node.name
    checked = 0
    for node in (n for n in STUBS.body if isinstance(n, ast.ClassDef) and n.name[0] != "_"):
        for method in (m for m in node.body if isinstance(m, ast.FunctionDef)):
            is_property = any(getattr(d, "id", "") == "property" for d in method.decorator_list)
            function = vars(getattr(lidarena, node.name)).get(method.name)
            if is_property or method.name in ("__exit__", "__enter__", "__len__", "__iter__", "__next__"):
                continue
            if "Overloaded" not in (function.__doc__ or ""):
                assert declared(method) == defined(function), f"{node.name}.{method.name}"
                checked += 1
    assert checked > 20


def test_plots_have_what_their_stubs_say():
    stubs = ast.parse(pathlib.Path(lidarena.plot.__file__).with_suffix(".pyi").read_text())
    functions = [node for node in stubs.body if isinstance(node, ast.FunctionDef)]
    assert {f.name for f in functions} == {
        name for name, value in vars(lidarena.plot).items() if inspect.isfunction(value) and name[0] != "_"}
    for function in functions:
        assert declared(function) == defined(getattr(lidarena.plot, function.name)), function.name
