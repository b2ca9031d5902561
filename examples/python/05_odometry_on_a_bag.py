#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Run an odometry on your bag. usage: 05_odometry_on_a_bag.py [BAG_OR_MCAP [ALGORITHM]]

Without a bag it first simulates one: 3 s in the House, as a ROS 1 bag.
"""
import pathlib
import sys
import tempfile

import lidarena


def record(file):
    world = lidarena.load_world("house")
    flight = lidarena.make_flight("house", world)
    sensor = lidarena.load_sensor("livox_mid360")
    with lidarena.DatasetWriter(file, lidarena.make_rig([sensor])) as writer:
        for sensor_id, data in lidarena.simulate(world, flight, [sensor], seconds=3.0):
            writer.write(sensor_id, data)


with tempfile.TemporaryDirectory() as folder:
    bag = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else f"{folder}/my.bag")
    if len(sys.argv) < 2:
        record(bag)
    dataset = lidarena.open_dataset(bag)
    for note in dataset.notes:
        print("note:", note)
    algorithm = sys.argv[2] if len(sys.argv) > 2 else "kiss_icp"
    odometry = lidarena.make_odometry(dataset.rig, algorithm)
    result = lidarena.run(odometry, dataset)
    summary = result.summary
    print(f"{algorithm}: {summary['scans']} scans, {result.trajectory.path_length:.2f} m, "
          f"{summary['sensor_seconds'] / summary['compute_seconds']:.1f} times real time, "
          f"a map of {len(result.map)} points")
    result.trajectory.write(f"{folder}/trajectory.tum")
    assert summary["scans"] > 0 and not summary["diverged"]
