#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Cast rays into a world: distances around a point in the House. usage: 01_cast_rays.py"""
import numpy as np

import lidarena

world = lidarena.load_world("house")
center = np.array([[2.0, 2.0, 1.2]])  # m
angles = np.arange(0.0, 2.0 * np.pi, np.radians(30.0))
directions = np.stack([np.cos(angles), np.sin(angles), np.zeros_like(angles)], axis=1)

hits = world.cast(center, directions, max_range=50.0)
for angle, distance in zip(np.degrees(angles), hits["range"]):
    print(f"{angle:4.0f} deg: {distance:6.2f} m" if np.isfinite(distance) else f"{angle:4.0f} deg: open")

nearest = world.closest_points(center)[0]
print(f"the nearest surface is {nearest['distance']:.3f} m away, at {nearest['point'].round(3)}")
assert nearest["distance"] <= hits["range"].min() + 1e-4
