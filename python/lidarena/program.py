# SPDX-License-Identifier: BSD-3-Clause
"""The command `lidarena` of an installation by pip: the program that lies in the package."""
import os
import pathlib
import sys


def main():
    """Becomes the program, with this process's arguments."""
    program = pathlib.Path(__file__).parent / "bin" / "lidarena"
    os.execv(program, ["lidarena", *sys.argv[1:]])
