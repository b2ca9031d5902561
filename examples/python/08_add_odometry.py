#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Add an odometry: it matches planes of grid cells, without a search. usage: 08_add_odometry.py

To use it in a study as a program, call lidarena.external.main(lambda rig: CellPlanes(rig)), and add
`external: - {name: mine, command: python3 mine.py {input} {output}, pose_of: body}`.
"""
import numpy as np

import lidarena

CELL = 1.0  # m
ITERATIONS = 5


def keys_of(points):
    """The cell of each point, as one integer."""
    cells = np.floor(points / CELL).astype(np.int64) + (1 << 20)
    return (cells[:, 0] << 42) | (cells[:, 1] << 21) | cells[:, 2]


def planes(points):
    """(keys, centroids, normals) of the cells with ten or more points that lie in a plane."""
    keys, cell, count = np.unique(keys_of(points), return_inverse=True, return_counts=True)
    means = np.stack([np.bincount(cell, points[:, i]) for i in range(3)], axis=1) / count[:, None]
    centered = points - means[cell]
    squares = np.stack([np.bincount(cell, centered[:, i] * centered[:, j])
                        for i in range(3) for j in range(3)], axis=1).reshape(-1, 3, 3)
    values, vectors = np.linalg.eigh(squares / count[:, None, None])
    flat = (count >= 10) & (values[:, 0] < 0.01 * values[:, 1])
    return keys[flat], means[flat], vectors[flat, :, 0]


class CellPlanes(lidarena.Odometry):
    """Translation only: aligns the cells of each scan with the planes of the first scan's cells."""

    def __init__(self, rig):
        super().__init__()
        self.body_from_lidar = lidarena.matrix(rig.lidars[0]["body_from_lidar"])
        self.position = np.zeros(3)
        self.reference = None

    def track(self, scan):
        rotation, offset = self.body_from_lidar[:3, :3], self.body_from_lidar[:3, 3]
        points = scan.positions.astype(float) @ rotation.T + offset
        if self.reference is None:
            self.reference = planes(points)
            return lidarena.ScanResult(scan.stamp, np.eye(4), status="initializing")
        matches = 0
        for _ in range(ITERATIONS):
            keys, means, _ = planes(points + self.position)
            _, here, there = np.intersect1d(keys, self.reference[0], return_indices=True)
            normals = self.reference[2][there]
            distances = np.einsum("ij,ij->i", normals, self.reference[1][there] - means[here])
            near = np.abs(distances) < 0.3
            matches = near.sum()
            if matches < 5:
                return self.result(scan, "too_few_points", matches)
            self.position += np.linalg.lstsq(normals[near], distances[near], rcond=None)[0]
        return self.result(scan, "tracked", matches)

    def result(self, scan, status, matches):
        pose = np.eye(4)
        pose[:3, 3] = self.position
        return lidarena.ScanResult(scan.stamp, pose, status, counters={"matches": float(matches)})

    def map(self):
        return self.reference[1].astype(np.float32)


if __name__ == "__main__":
    house = lidarena.load_world("house")
    stamps = np.arange(0, 1_500_000_001, 50_000_000)
    poses = np.tile(np.eye(4), (len(stamps), 1, 1))
    start = lidarena.make_flight("house", house).at(0).pose[:3, 3]
    poses[:, :3, 3] = start
    poses[:, 0, 3] += 0.1 * (1 - np.cos(np.pi * stamps / 1.5e9))  # 0.2 m, from rest to rest
    flight = lidarena.replay(lidarena.Trajectory(stamps, poses))
    sensor = lidarena.load_sensor("ouster_os1_64")
    events = lidarena.simulate(house, flight, [sensor], seconds=1.5)
    result = lidarena.run(CellPlanes(lidarena.make_rig([sensor])), events)
    moved = result.trajectory.positions[-1] - result.trajectory.positions[0]
    print(f"moved {moved.round(3)} m, true motion 0.2 m along x; {result.summary['statuses']}")
    assert np.linalg.norm(moved - [0.2, 0, 0]) < 0.05  # a quarter of the true translation
