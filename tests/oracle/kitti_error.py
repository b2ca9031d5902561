#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The KITTI odometry error as defined in docs/metrics.md, written independently of the library.

    kitti_error.py TRUTH ESTIMATE [LENGTH ...]     rows of 12 numbers (13: frame number first)

Prints the number of pieces, translation error in % and rotation error in deg/100 m, for each length
and for all together. tests/evaluation/kitti_error_test.cpp contains its results.
"""
import math
import sys


def load(path):
    frames = {}
    for line in open(path):
        values = [float(word) for word in line.split()]
        frame = int(values.pop(0)) if len(values) == 13 else len(frames)
        frames[frame] = [values[0:4], values[4:8], values[8:12]]
    return frames


def from_start(a, b):
    """a^-1 b"""
    rotation = [[sum(a[k][i] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]
    move = [b[k][3] - a[k][3] for k in range(3)]
    return [rotation[i] + [sum(a[k][i] * move[k] for k in range(3))] for i in range(3)]


def angle(m):
    sine = math.hypot(m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]) / 2
    return math.atan2(sine, (m[0][0] + m[1][1] + m[2][2] - 1) / 2)


def errors(truth, estimate, length):
    path, length_so_far, last = {}, 0.0, None
    for frame in sorted(truth):
        here = [row[3] for row in truth[frame]]
        length_so_far += math.dist(here, last) if last else 0.0
        path[frame], last = length_so_far, here
    common = [frame for frame in sorted(estimate) if frame in truth]
    for start in common[::10]:
        end = next((f for f in common if path[f] > path[start] + length), None)
        if end is not None:
            error = from_start(from_start(estimate[start], estimate[end]),
                               from_start(truth[start], truth[end]))
            yield math.hypot(*(row[3] for row in error)) / length, angle(error) / length


def show(name, values):
    if values:
        t, r = (sum(column) / len(values) for column in zip(*values))
        print(f"{name:>6} {len(values):5} {100 * t:.9f} % {math.degrees(r) * 100:.9f} deg/100m")


if __name__ == "__main__":
    truth, estimate = load(sys.argv[1]), load(sys.argv[2])
    together = []
    for length in map(float, sys.argv[3:] or range(100, 900, 100)):
        values = list(errors(truth, estimate, length))
        show(f"{length:g}", values)
        together += values
    show("all", together)
