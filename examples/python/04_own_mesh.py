#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Use a mesh of your own: arrays, or OBJ, PLY, STL, DAE, glTF. usage: 04_own_mesh.py [FOLDER]"""
import pathlib
import sys

import numpy as np

import lidarena

folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "out/own_mesh")
folder.mkdir(parents=True, exist_ok=True)

# a wavy surface of 20 m x 20 m
n = 81
x, y = np.meshgrid(np.linspace(-10, 10, n), np.linspace(-10, 10, n), indexing="ij")
vertices = np.stack([x, y, 0.3 * np.sin(x) * np.cos(y)], axis=-1).reshape(-1, 3)
corner = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
triangles = np.concatenate([np.stack([corner, corner + n, corner + n + 1], 1),
                            np.stack([corner, corner + n + 1, corner + 1], 1)])
world = lidarena.World(vertices, triangles, name="waves")
world.save(folder / "waves.ply")

reloaded = lidarena.load_world(folder / "waves.ply")
assert len(reloaded.triangles) == len(triangles)

# hover 3 m above it for one second
stamps = np.arange(0, 1_000_000_001, 100_000_000)
poses = np.tile(np.eye(4), (len(stamps), 1, 1))
poses[:, 2, 3] = 3.0
flight = lidarena.replay(lidarena.Trajectory(stamps, poses))
sensor = lidarena.load_sensor("ouster_os1_64")
scan, truth = lidarena.Lidar(sensor).measure(reloaded, flight, 0, truth=True)
height = 0.3 * np.sin(truth["position"][:, 0]) * np.cos(truth["position"][:, 1])
print(f"{len(scan)} points within {abs(truth['position'][:, 2] - height).max() * 100:.1f} cm "
      "of the surface that the mesh approximates")
assert len(scan) > 1000
