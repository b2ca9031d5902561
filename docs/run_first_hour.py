#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs every command of docs/first_hour.md, in order, in an empty folder.

usage: run_first_hour.py PROGRAM

Fails if a command fails, or if a line of output that the page shows is not among those printed.
Numbers may differ, since times do; lines of dots stand for lines left out.
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

PAGE = pathlib.Path(__file__).parent / "first_hour.md"


def steps(page):
    """Each command of the page with the lines that it shows of its output."""
    found = []
    for block in re.findall(r"^```console\n(.*?)^```", page, re.DOTALL | re.MULTILINE):
        for line in block.splitlines():
            if line.startswith("$ "):
                found.append((line[2:], []))
            elif line != "...":
                found[-1][1].append(line)
    return found


def without_numbers(line):
    return " ".join(re.sub(r"[-+]?\d[\d.:e+-]*", "#", line).split())


def main():
    program = pathlib.Path(sys.argv[1]).resolve()
    commands = steps(PAGE.read_text())
    with tempfile.TemporaryDirectory() as folder:
        environment = {**os.environ, "PATH": f"{program.parent}:{os.environ['PATH']}"}
        for command, shown in commands:
            print(f"$ {command}", flush=True)
            done = subprocess.run(command, shell=True, cwd=folder, env=environment, text=True,
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
            printed = {without_numbers(line) for line in done.stdout.splitlines()}
            missing = [line for line in shown if without_numbers(line) not in printed]
            if done.returncode != 0 or missing:
                print(done.stdout)
                print(f"exit code {done.returncode}; shown on the page, but not printed:", *missing,
                      sep="\n  ")
                return 1
    print(f"{len(commands)} commands")
    return 0 if commands else 1


if __name__ == "__main__":
    sys.exit(main())
