#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Draws maps of runs side by side, seen from above, each point colored by its distance from the mesh.

usage: PYTHONPATH=build/release/python draw_maps.py PICTURE.png TITLE=RUN_FOLDER...

The folders are those of `lidarena run`, after `lidarena evaluate` has written their scored.ply.
"""
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

import lidarena.plot


def scored(folder):
    """Points (N, 3) and their distances (N) from the mesh, m."""
    header, _, body = (pathlib.Path(folder) / "scored.ply").read_bytes().partition(b"end_header\n")
    count = int(header.split(b"element vertex ")[1].split()[0])
    rows = np.frombuffer(body, "<f4", 4 * count).reshape(count, 4)
    return rows[:, :3], rows[:, 3]


def main():
    if len(sys.argv) < 3 or not all("=" in argument for argument in sys.argv[2:]):
        raise SystemExit(__doc__)
    maps = [argument.split("=", 1) for argument in sys.argv[2:]]
    figure, axes = plt.subplots(1, len(maps), figsize=(5.2 * len(maps), 4.0), sharex=True, sharey=True, squeeze=False,
                                layout="constrained")
    for ax, (title, folder) in zip(axes[0], maps):
        points, distances = scored(folder)
        lidarena.plot.map_error(points, distances, ax)
        beyond = 100.0 * np.mean(distances > lidarena.plot.LIMIT)
        ax.set_title(f"{title}\n{beyond:.2f} % beyond {100.0 * lidarena.plot.LIMIT:.0f} cm", fontsize=10)
    figure.savefig(sys.argv[1], dpi=100)


if __name__ == "__main__":
    main()
