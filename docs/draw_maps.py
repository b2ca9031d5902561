#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Draws maps of runs side by side, seen from above, each point colored by its distance from the mesh.

usage: draw_maps.py PICTURE.png TITLE=RUN_FOLDER...

The folders are those of `lidarena run`, after `lidarena evaluate` has written their scored.ply. Every point
beyond 20 cm is drawn above the others.
"""
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

LIMIT_CM = 20.0


def scored(folder):
    """x, y (m) and distance (cm) of the scored points."""
    data = (pathlib.Path(folder) / "scored.ply").read_bytes()
    header, _, body = data.partition(b"end_header\n")
    count = int(header.split(b"element vertex ")[1].split()[0])
    points = np.frombuffer(body, "<f4", 4 * count).reshape(count, 4)
    order = np.argsort(points[:, 3])
    return points[order][:, [0, 1]], 100.0 * points[order][:, 3]


def main():
    if len(sys.argv) < 3 or not all("=" in a for a in sys.argv[2:]):
        raise SystemExit(__doc__)
    maps = [argument.split("=", 1) for argument in sys.argv[2:]]
    figure, axes = plt.subplots(1, len(maps), figsize=(5.2 * len(maps), 4.4), sharex=True, sharey=True, squeeze=False,
                                layout="constrained")
    for ax, (title, folder) in zip(axes[0], maps):
        points, distance = scored(folder)
        dots = ax.scatter(*points.T, c=distance, s=0.2, cmap="turbo", vmin=0.0, vmax=LIMIT_CM, linewidths=0, rasterized=True)
        ax.set_title(f"{title}\n{100.0 * np.mean(distance > LIMIT_CM):.2f} % beyond {LIMIT_CM:.0f} cm", fontsize=10)
        ax.set_aspect("equal")
        ax.set_xlabel("x / m")
    axes[0][0].set_ylabel("y / m")
    figure.colorbar(dots, ax=axes[0], label="distance from the mesh / cm", extend="max")
    figure.savefig(sys.argv[1], dpi=110)


if __name__ == "__main__":
    main()
