#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Define a study: which voxel size suits which sensor? usage: 07_own_study.py [FOLDER]

`lidarena study` runs matrices of worlds, sensors and algorithms, with a report and statistics; this
example varies a parameter.
"""
import pathlib
import sys

import numpy as np

import lidarena

folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "out/own_study")
world = lidarena.load_world("house")
flight = lidarena.make_flight("house", world)

rows = []
for name in ("livox_mid360", "velodyne_vlp16"):
    lidarena.simulate_dataset("house", "house", [name], folder / name, seconds=3.0)
    for voxel in (0.3, 1.0):
        dataset = lidarena.open_dataset(folder / name)
        odometry = lidarena.make_odometry(dataset.rig, "kiss_icp",
                                          overrides=[f"voxel_size_m={voxel}"])
        result = lidarena.run(odometry, dataset)
        truth = lidarena.load_truth(folder / name)
        metrics = lidarena.evaluate(result.trajectory, truth)
        error = metrics["live"]["rpe"]["1s"]["translation"]["rmse_m"]
        rows.append((name, voxel, 100 * error, result.summary["compute_seconds"]))
        print(f"{name:16} voxel {voxel:.1f} m: {100 * error:6.2f} cm RPE over 1 s, "
              f"{rows[-1][3]:.2f} s of computing time")
assert len(rows) == 4 and np.isfinite([row[2:] for row in rows]).all()
