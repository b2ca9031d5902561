#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Fails if pyflakes finds fault with a Python file of the project: an undefined name, an unused
variable or import. Scripts that run only in a simulator or by hand are covered too.

Exits with 77 (skipped) if pyflakes is not installed.
"""
import os
import sys

try:
    from pyflakes import checker, messages
except ImportError:
    print("skipped: pyflakes is not installed (python3-pyflakes)")
    sys.exit(77)
import ast

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
NOT_OURS = {"build", "build-gazebo", "node_modules", ".git"}


def python_files(folder):
    for place, folders, names in os.walk(folder):
        folders[:] = sorted(name for name in folders if name not in NOT_OURS)
        yield from (os.path.join(place, name) for name in sorted(names) if name.endswith(".py"))


def faults(path):
    with open(path, encoding="utf-8") as file:
        found = checker.Checker(ast.parse(file.read(), path), path).messages
    if os.path.basename(path) == "__init__.py":  # imports names for others
        found = [message for message in found if not isinstance(message, messages.UnusedImport)]
    return found


def main():
    files = list(python_files(ROOT))
    assert any(path.endswith("adapters/gazebo/test/run.py") for path in files), "the project's files"
    found = [message for path in files for message in faults(path)]
    for message in found:
        print(message)
    print(f"{len(files)} files, {len(found)} faults")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
