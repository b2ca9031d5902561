#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Score the trajectory and map of any program. usage: 06_evaluate.py [ESTIMATE TRUTH [MAP MESH]]

Trajectories are TUM, KITTI or EuRoC files; the map is PLY or PCD in the estimate's frame. Without
files it uses a generated estimate with a drift of 1 % and a map, so that the results are known.
"""
import sys

import numpy as np

import lidarena


def generated():
    world = lidarena.load_world("house")
    flight = lidarena.make_flight("house", world)
    truth = flight.sample(np.arange(0, flight.duration, 50_000_000))
    drifted = truth.poses.copy()
    drifted[:, :3, 3] = truth.positions[0] + 1.01 * (truth.positions - truth.positions[0])
    corners = np.asarray(world.vertices, np.float32)
    return lidarena.Trajectory(truth.stamps, drifted), truth, corners, world


if len(sys.argv) > 2:
    estimate, truth = map(lidarena.read_trajectory, sys.argv[1:3])
    cloud = lidarena.read_cloud(sys.argv[3]) if len(sys.argv) > 4 else None
    world = lidarena.load_world(sys.argv[4]) if len(sys.argv) > 4 else None
else:
    estimate, truth, cloud, world = generated()

metrics = lidarena.evaluate(estimate, truth)
for warning in metrics["warnings"]:
    print("warning:", warning)
one_meter = metrics["live"]["rpe"]["1m"]["translation"]
print(f"relative error over 1 m: {100 * one_meter['rmse_m']:.2f} cm RMSE "
      f"of {one_meter['count']} pieces")
if cloud is not None:
    figures, distances = lidarena.map_error(cloud, world)
    print(f"map: {len(distances)} points, {100 * np.nanmean(distances):.2f} cm from the mesh on "
          f"average, {figures['outliers_percent']:.1f} % beyond 20 cm")
if len(sys.argv) < 3:
    assert 0.002 < one_meter["rmse_m"] < 0.011  # 1 % of at most 1 m, the chord of a piece
    assert np.nanmax(distances) < 1e-5  # the map consists of the mesh's vertices
