#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Fly a Mid-360 through the House and write its data. usage: 02_simulate_flight.py [FOLDER]"""
import sys

import lidarena

folder = sys.argv[1] if len(sys.argv) > 1 else "out/house_flight"
done = lidarena.simulate_dataset("house", "house", ["livox_mid360"], folder, seed=1, seconds=2.0)
print(f"{done['scans']} scans, {done['points']} points, {done['imu_samples']} IMU samples along "
      f"{done['path_m']:.2f} m, in {folder}")

# Events are read in order, each scan after the IMU samples that span it.
dataset = lidarena.open_dataset(folder)
for sensor_id, data in dataset:
    if isinstance(data, lidarena.Scan):
        print(f"first scan of {sensor_id}: {len(data)} points, "
              f"the nearest {abs(data.positions).max(axis=1).min():.2f} m away")
        break
assert done["scans"] == 20 and dataset.scan_count == 20
