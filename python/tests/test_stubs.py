# SPDX-License-Identifier: BSD-3-Clause
"""The type stubs declare exactly the public names of the module."""
import ast
import importlib
import pathlib

import lidarena

STUBS = ast.parse(pathlib.Path(lidarena.__file__).with_name("__init__.pyi").read_text())


def public(names):
    return {n for n in names if not n.startswith("_")}


def test_the_module_has_what_the_stubs_say():
    said = {node.name for node in STUBS.body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}
    said |= {node.target.id for node in STUBS.body if isinstance(node, ast.AnnAssign)}
    assert public(said) == public(dir(lidarena)) - {"external"}
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
