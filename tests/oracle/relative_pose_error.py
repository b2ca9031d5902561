#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""RPE per meter as defined in docs/metrics.md; simple, slow, independent of the library.

    relative_pose_error.py FILE.json      with {"files": {name: TUM text}}; prints used, total, cm

tests/evaluation/known_figures_test.cpp contains its results.
"""
import bisect
import json
import math
import statistics
import sys


def load(text):
    poses = []
    for line in text.splitlines():
        if line.strip() and not line.startswith("#"):
            stamp, *values = line.split()
            whole, decimals = stamp.split(".")
            x, y, z, *q = map(float, values)
            norm = math.hypot(*q)
            poses.append((int(whole + decimals.ljust(9, "0")), (x, y, z), [c / norm for c in q]))
    return poses


def slerp(a, b, s):
    cosine = sum(x * y for x, y in zip(a, b))
    if cosine < 0:
        b, cosine = [-x for x in b], -cosine
    if cosine > 1 - 1e-14:
        return a
    angle = math.acos(cosine)
    u, v = math.sin((1 - s) * angle) / math.sin(angle), math.sin(s * angle) / math.sin(angle)
    return [u * x + v * y for x, y in zip(a, b)]


def into_frame(q, v):
    """v in a frame rotated by q: R(q)^T v."""
    x, y, z, w = -q[0], -q[1], -q[2], q[3]
    t = [2 * (y * v[2] - z * v[1]), 2 * (z * v[0] - x * v[2]), 2 * (x * v[1] - y * v[0])]
    return [v[0] + w * t[0] + y * t[2] - z * t[1],
            v[1] + w * t[1] + z * t[0] - x * t[2],
            v[2] + w * t[2] + x * t[1] - y * t[0]]


def at(poses, t, bracket):
    times = [p[0] for p in poses]
    i = bisect.bisect_right(times, t)
    if i > 0 and times[i - 1] == t:
        return poses[i - 1][1:]
    if i == 0 or i == len(poses) or times[i] - times[i - 1] > bracket:
        return None
    (ta, pa, qa), (tb, pb, qb) = poses[i - 1], poses[i]
    s = (t - ta) / (tb - ta)
    return [u + s * (v - u) for u, v in zip(pa, pb)], slerp(qa, qb, s)


def step_in_start_frame(poses, a, b):
    bracket = 1.5 * statistics.median(q[0] - p[0] for p, q in zip(poses, poses[1:]))
    start, end = at(poses, a, bracket), at(poses, b, bracket)
    if start is None or end is None:
        return None
    return into_frame(start[1], [v - u for u, v in zip(start[0], end[0])])


def rpe(truth, estimate, segment=1.0):
    first, last = max(truth[0][0], estimate[0][0]), min(truth[-1][0], estimate[-1][0])
    inside = [p for p in truth if first <= p[0] <= last]
    s = [0.0]
    for p, q in zip(inside, inside[1:]):
        s.append(s[-1] + math.dist(p[1], q[1]))

    def time_at(length):
        i = min(bisect.bisect_left(s, length), len(s) - 1)
        if i == 0:
            return inside[0][0]
        ta, tb = inside[i - 1][0], inside[i][0]
        return ta + round(min(1.0, (length - s[i - 1]) / (s[i] - s[i - 1])) * (tb - ta))

    total = math.floor((s[-1] + 1e-6) / segment)
    squares = []
    for k in range(total):
        ends = time_at(k * segment), time_at((k + 1) * segment)
        steps = [step_in_start_frame(t, *ends) for t in (truth, estimate)]
        if None not in steps:
            squares.append(math.dist(*steps) ** 2)
    return len(squares), total, 100 * math.sqrt(sum(squares) / len(squares))


if __name__ == "__main__":
    files = json.load(open(sys.argv[1]))["files"]
    for truth, estimate in (("uav_ref", "uav_est"), ("uav_ref", "uav_est_gap"),
                            ("hover_ref", "hover_est")):
        used, total, cm = rpe(load(files[truth + ".tum"]), load(files[estimate + ".tum"]))
        print(f"{estimate:12} {used} of {total}  {cm:.6f} cm")
