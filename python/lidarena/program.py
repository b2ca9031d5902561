# SPDX-License-Identifier: BSD-3-Clause
"""The command `lidarena` of an installation by pip: starts the program inside the package."""
import os
import pathlib
import sys


def main():
    """Replaces this process by the program, with the same arguments."""
    program = pathlib.Path(__file__).parent / "bin" / "lidarena"
    os.execv(program, ["lidarena", *sys.argv[1:]])
