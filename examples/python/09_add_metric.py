#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Add a metric: how flat are the floor and walls of a map? usage: 09_add_metric.py

A metric is a function of a run's results (trajectory, map) and of the truth (trajectory, mesh).
This one fits a plane to the map points nearest to each triangle; RMS distance in meters.
"""
import numpy as np

import lidarena


def flatness(cloud, world, reach=0.2, min_points=100):
    """RMS distance (m) of points to the best-fit plane of each face.

    `cloud` (N, 3) is in the mesh's frame; uses points within `reach` meters of a face, and faces
    that have `min_points` points or more. Returns NaN if there is no such face.
    """
    nearest = world.closest_points(cloud, max_distance=reach)
    faces = nearest["triangle"]
    squares, count = 0.0, 0
    for face in np.unique(faces[np.isfinite(nearest["distance"])]):
        points = cloud[faces == face].astype(float)
        if len(points) < min_points:
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
