# SPDX-License-Identifier: BSD-3-Clause
"""Runs the tests of the Python module; exits 77 (skipped) and says why where something is missing."""
import importlib.util
import pathlib
import sys

for module, package in (("numpy", "python3-numpy"), ("pytest", "python3-pytest"),
                        ("lidarena", "a build with pybind11-dev and python3-dev")):
    if importlib.util.find_spec(module) is None:
        print(f"skipped: there is no Python module {module} (it comes with {package})")
        sys.exit(77)

import pytest  # noqa: E402

sys.exit(pytest.main(["-q", "-p", "no:cacheprovider", str(pathlib.Path(__file__).parent)]))
