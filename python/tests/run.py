# SPDX-License-Identifier: BSD-3-Clause
"""Runs the tests of the Python module; names what is missing, if anything, and exits with 77."""
import importlib.util
import pathlib
import sys

for module, package in (("numpy", "python3-numpy"), ("pytest", "python3-pytest"),
                        ("lidarena", "a build with pybind11-dev and python3-dev")):
    if importlib.util.find_spec(module) is None:
        print(f"skipped: no Python module {module} (needs {package})")
        sys.exit(77)

import pytest  # noqa: E402

sys.exit(pytest.main(["-q", "-p", "no:cacheprovider", str(pathlib.Path(__file__).parent)]))
