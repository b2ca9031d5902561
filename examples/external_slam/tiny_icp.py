#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""A very small LiDAR odometry, to show how a study runs a program of yours.

usage: tiny_icp.py SWEEPS OUTPUT

SWEEPS is a folder of one LiDAR's sweeps (000000.pcd ... and times.txt); trajectory.tum (pose of
the LiDAR at each sweep's stamp) and map.ply are written to the folder OUTPUT. Point-to-point ICP
of each sweep, downsampled to one point per voxel, to all earlier sweeps, with a constant-velocity
prediction. Needs only numpy.
"""
import pathlib
import sys

import numpy as np

VOXEL = 0.4  # m
MAX_MATCH_DISTANCE = 1.0  # m, maximum distance of a match
ITERATIONS = 15


def read_pcd(path):
    """Positions (N, 3) from a binary PCD with x y z as float32."""
    data = path.read_bytes()
    end = data.index(b"DATA binary\n") + len(b"DATA binary\n")
    header = dict(line.split(" ", 1) for line in data[:end].decode().splitlines() if " " in line)
    names, sizes = header["FIELDS"].split(), [int(s) for s in header["SIZE"].split()]
    counts = [int(c) for c in header["COUNT"].split()]
    step = sum(s * c for s, c in zip(sizes, counts))
    rows = np.frombuffer(data, np.uint8, step * int(header["POINTS"]), end).reshape(-1, step)
    first = sum(s * c for s, c, n in zip(sizes, counts, names) if names.index(n) < names.index("x"))
    return rows[:, first:first + 12].copy().view(np.float32).astype(float)


def downsampled(points, voxel):
    """The first point in each voxel."""
    cells = np.floor(points / voxel).astype(np.int64)
    return points[np.sort(np.unique(cells, axis=0, return_index=True)[1])]


class VoxelMap:
    """One point per voxel; nearest neighbors are searched in the 27 voxels around a point."""

    def __init__(self, voxel):
        self.voxel, self.points = voxel, {}

    def add(self, points):
        for cell, point in zip(map(tuple, np.floor(points / self.voxel).astype(int)), points):
            self.points.setdefault(cell, point)

    def nearest(self, points, reach):
        """Pairs (index into points, map point) closer than `reach`."""
        cells = np.floor(points / self.voxel).astype(int)
        around = [(i, j, k) for i in (-1, 0, 1) for j in (-1, 0, 1) for k in (-1, 0, 1)]
        which, found = [], []
        for index, (cell, point) in enumerate(zip(cells, points)):
            there = [self.points.get((cell[0] + i, cell[1] + j, cell[2] + k)) for i, j, k in around]
            there = [p for p in there if p is not None]
            if not there:
                continue
            distances = np.linalg.norm(np.array(there) - point, axis=1)
            best = int(np.argmin(distances))
            if distances[best] < reach:
                which.append(index)
                found.append(there[best])
        return np.array(which, int), np.array(found)


def rigid_fit(source, target):
    """The rigid transform that best aligns source with target (Arun, Huang and Blostein 1987)."""
    a, b = source.mean(axis=0), target.mean(axis=0)
    u, _, vt = np.linalg.svd((source - a).T @ (target - b))
    rot = vt.T @ np.diag([1, 1, np.sign(np.linalg.det(vt.T @ u.T))]) @ u.T
    fit = np.eye(4)
    fit[:3, :3], fit[:3, 3] = rot, b - rot @ a
    return fit


def quaternion(rot):
    """Quaternion x y z w of a rotation matrix, computed from its largest component."""
    four = np.array([1 + rot[0, 0] - rot[1, 1] - rot[2, 2], 1 - rot[0, 0] + rot[1, 1] - rot[2, 2],
                     1 - rot[0, 0] - rot[1, 1] + rot[2, 2], 1 + np.trace(rot)])
    rows = np.array([[four[0], rot[0, 1] + rot[1, 0], rot[0, 2] + rot[2, 0], rot[2, 1] - rot[1, 2]],
                     [rot[0, 1] + rot[1, 0], four[1], rot[1, 2] + rot[2, 1], rot[0, 2] - rot[2, 0]],
                     [rot[0, 2] + rot[2, 0], rot[1, 2] + rot[2, 1], four[2], rot[1, 0] - rot[0, 1]],
                     [rot[2, 1] - rot[1, 2], rot[0, 2] - rot[2, 0], rot[1, 0] - rot[0, 1], four[3]]])
    best = rows[int(np.argmax(four))]
    return best / np.linalg.norm(best)


def main(sweeps, output):
    stamps = sweeps.joinpath("times.txt").read_text().split()
    world, pose, motion = VoxelMap(VOXEL), np.eye(4), np.eye(4)
    rows = ["# world_from_lidar"]
    for stamp, sweep in zip(stamps, sorted(sweeps.glob("*.pcd"))):
        points = downsampled(read_pcd(sweep), VOXEL)
        before, pose = pose, pose @ motion
        for _ in range(ITERATIONS if world.points else 0):
            placed = points @ pose[:3, :3].T + pose[:3, 3]
            which, found = world.nearest(placed, MAX_MATCH_DISTANCE)
            if len(which) < 10:
                break
            step = rigid_fit(placed[which], found)
            pose = step @ pose
            if np.linalg.norm(step - np.eye(4)) < 1e-3:
                break
        motion = np.linalg.inv(before) @ pose
        world.add(points @ pose[:3, :3].T + pose[:3, 3])
        rows.append(" ".join([stamp, *(f"{v:.9f}" for v in [*pose[:3, 3], *quaternion(pose[:3, :3])])]))
    output.joinpath("trajectory.tum").write_text("\n".join(rows) + "\n")
    cloud = np.array(list(world.points.values()), np.float32)
    header = "ply\nformat binary_little_endian 1.0\nelement vertex %d\n" % len(cloud)
    header += "".join(f"property float {axis}\n" for axis in "xyz") + "end_header\n"
    output.joinpath("map.ply").write_bytes(header.encode() + cloud.tobytes())


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    folder = pathlib.Path(sys.argv[1])
    # A dataset of sweeps contains a folder for each sensor; here there is only one.
    inside = [f.parent for f in folder.glob("*/times.txt")]
    main(inside[0] if inside else folder, pathlib.Path(sys.argv[2]))
