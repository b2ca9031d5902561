#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Prints rows `time x y z qx qy qz qw` from a file of poses and one of times.

usage: tum_from_kitti.py POSES TIMES

POSES has the first three rows of a pose's matrix in each line (12 numbers); TIMES has a time, s,
as the first word of each line. KISS-ICP and GenZ-ICP write both; their own rows of the second
format have only four decimals.
"""
import math
import sys


def quaternion(m):
    """Quaternion x, y, z, w of the rotation in a 3x4 matrix given as 12 numbers by rows."""
    xx, xy, xz, _, yx, yy, yz, _, zx, zy, zz, _ = m
    if xx + yy + zz > 0:
        s = 2 * math.sqrt(1 + xx + yy + zz)
        q = (zy - yz) / s, (xz - zx) / s, (yx - xy) / s, s / 4
    elif xx >= yy and xx >= zz:
        s = 2 * math.sqrt(1 + xx - yy - zz)
        q = s / 4, (xy + yx) / s, (xz + zx) / s, (zy - yz) / s
    elif yy >= zz:
        s = 2 * math.sqrt(1 + yy - xx - zz)
        q = (xy + yx) / s, s / 4, (yz + zy) / s, (xz - zx) / s
    else:
        s = 2 * math.sqrt(1 + zz - xx - yy)
        q = (xz + zx) / s, (yz + zy) / s, s / 4, (yx - xy) / s
    norm = math.sqrt(sum(v * v for v in q))
    return [v / norm for v in q]


def rows(path):
    with open(path, encoding="utf-8") as lines:
        return [line.split() for line in lines if line.strip() and not line.startswith("#")]


def main(poses_file, times_file):
    poses, times = rows(poses_file), rows(times_file)
    if len(poses) != len(times):
        sys.exit(f"{poses_file} has {len(poses)} poses, {times_file} has {len(times)} times")
    for pose, time in zip(poses, times):
        matrix = [float(v) for v in pose]
        if len(matrix) != 12:
            sys.exit(f"{poses_file}: a line has {len(matrix)} numbers, not 12")
        values = [matrix[3], matrix[7], matrix[11], *quaternion(matrix)]
        print(time[0], *(f"{v:.9g}" for v in values))


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2])
