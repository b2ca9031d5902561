#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Define a sensor: eight lasers on a spinning head. usage: 03_own_sensor.py [FOLDER]"""
import pathlib
import sys

import numpy as np

import lidarena

folder = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "out/own_sensor")
folder.mkdir(parents=True, exist_ok=True)
(folder / "my_beams.yaml").write_text(
    "beams:\n" + "".join(f"  - {{elevation_deg: {e}}}\n" for e in range(-14, 18, 4)))
(folder / "my_sensor.yaml").write_text("""\
model: beam_table
pattern_file: my_beams.yaml
columns: 360
rate_hz: 10
min_range_m: 0.3
max_range_m: 30
range_noise_m: 0.01
""")

sensor = lidarena.load_sensor(folder / "my_sensor.yaml")
for name, unit, meaning in lidarena.Sensor.fields()[:4]:
    print(f"{name} {unit}: {meaning}")

world = lidarena.load_world("house")
flight = lidarena.make_flight("house", world)
scan, truth = lidarena.Lidar(sensor).measure(world, flight, 5, truth=True)
error = np.linalg.norm(scan.positions, axis=1) - truth["range"]
print(f"{len(scan)} of {8 * 360} shots gave a return, range error {error.std() * 100:.2f} cm")
assert set(scan.points["ring"]) == set(range(8))
assert abs(error.std() - 0.01) < 0.001  # the file's range_noise_m
