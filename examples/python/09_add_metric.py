#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Add a metric: how straight are the floor and walls of a map? usage: 09_add_metric.py

A metric is a function of what a run leaves (trajectory, map) and of the truth (trajectory, mesh).
This one: RMS of a plane fitted to the map points nearest to each large triangle, in meters.
"""
import numpy as np

import lidarena


def flatness(cloud, world, reach=0.2, least=100):
    """RMS distance (m) of points to the plane that fits them best, face by face.

    `cloud` (N, 3) in the mesh's frame; only points within `reach` meters of a face count, and faces
    with at least `least` points. Returns NaN where there is none.
    """
    nearest = world.closest_points(cloud, max_distance=reach)
    faces = nearest["triangle"]
    squares, count = 0.0, 0
    for face in np.unique(faces[np.isfinite(nearest["distance"])]):
        points = cloud[faces == face].astype(float)
        if len(points) < least:
            continue
        centered = points - points.mean(axis=0)
        squares += np.linalg.svd(centered, compute_uv=False)[2] ** 2
        count += len(points)
    return np.sqrt(squares / count) if count else np.nan


if __name__ == "__main__":
    # A floor sampled with 1 cm of noise must come out as 1 cm.
    floor = lidarena.World([[-5, -5, 0], [5, -5, 0], [5, 5, 0], [-5, 5, 0]], [[0, 1, 2], [0, 2, 3]])
    rng = np.random.default_rng(1)
    cloud = rng.uniform(-5, 5, (20_000, 3))
    cloud[:, 2] = 0.01 * rng.normal(size=len(cloud))
    value = flatness(cloud, floor)
    print(f"flatness of a floor with 1 cm of noise: {100 * value:.3f} cm")
    assert abs(value - 0.01) < 3 * 0.01 / np.sqrt(2 * len(cloud))  # three sigma of an RMS
