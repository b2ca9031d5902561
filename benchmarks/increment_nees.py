#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""How honest the covariance of a method is: the normalized estimation error squared (NEES) of pose increments.

usage: PYTHONPATH=build/release/python increment_nees.py DATASET... [--algorithm arena_lio]

An increment is the motion between two live poses that are 1 s, or 1 m of path, apart. Its covariance is that of both
poses, taken as independent. Prints for each dataset the mean NEES per degree of freedom of translation and rotation
(1 is honest, more is too sure), the RMS error and the RMS of the standard deviation, both per axis.
"""
import argparse

import numpy as np

import lidarena


def hat(v):
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


def rotation_vector(rotation):
    """For angles well below pi."""
    axis = 0.5 * np.array([rotation[2, 1] - rotation[1, 2], rotation[0, 2] - rotation[2, 0],
                           rotation[1, 0] - rotation[0, 1]])
    sine = np.linalg.norm(axis)
    return axis if sine < 1e-9 else axis * np.arctan2(sine, 0.5 * (np.trace(rotation) - 1.0)) / sine


def run(dataset, algorithm):
    """[(stamp, pose, covariance)] of the scans that have a covariance."""
    source = lidarena.open_dataset(dataset)
    odometry = lidarena.make_odometry(source.rig, algorithm, threads=1)
    poses = []
    for _, data in source:
        if isinstance(data, lidarena.ImuSample):
            odometry.register_imu(data)
        else:
            result = odometry.register_scan(data)
            if result.status == "tracked" and result.covariance is not None:
                poses.append((result.stamp, result.pose, result.covariance))
    return poses


def increment(first, second, true_first, true_second):
    """Error (translation, rotation vector) and covariances of the motion between two poses, in the axes of the
    first one for the translation and of the second one for the rotation."""
    (_, a, cov_a), (_, b, cov_b) = first, second
    moved, truly = np.linalg.inv(a) @ b, np.linalg.inv(true_first) @ true_second
    axes, arm = a[:3, :3], hat(moved[:3, 3])
    of_translation = axes.T @ (cov_a[:3, :3] + cov_b[:3, :3]) @ axes + arm @ cov_a[3:, 3:] @ arm.T
    turn = moved[:3, :3]
    of_rotation = cov_b[3:, 3:] + turn.T @ cov_a[3:, 3:] @ turn
    return ((moved[:3, 3] - truly[:3, 3], of_translation),
            (rotation_vector(truly[:3, :3].T @ moved[:3, :3]), of_rotation))


def pairs(poses, truth, span_s, span_m):
    """Indices of two poses that are a time, or a length of the true path, apart."""
    path = np.concatenate([[0.0], np.cumsum([np.linalg.norm(b[:3, 3] - a[:3, 3])
                                             for a, b in zip(truth, truth[1:])])])
    stamps = 1e-9 * np.array([stamp for stamp, _, _ in poses])
    for i in range(len(poses)):
        along, span = (stamps, span_s) if span_s else (path, span_m)
        j = int(np.searchsorted(along, along[i] + span - 1e-6))
        if j < len(poses) and j > i:
            yield i, j


def report(dataset, algorithm):
    poses = run(dataset, algorithm)
    flight = lidarena.replay(lidarena.load_truth(dataset))
    begin = int(lidarena.load_truth(dataset).stamps[0])
    poses = [p for p in poses if begin <= p[0] <= begin + flight.duration]
    truth = [flight.at(p[0] - begin).pose for p in poses]
    for name, span_s, span_m in (("1 s", 1.0, 0.0), ("1 m", 0.0, 1.0)):
        parts = [increment(poses[i], poses[j], truth[i], truth[j]) for i, j in pairs(poses, truth, span_s, span_m)]
        text = []
        for k, unit in ((0, "mm"), (1, "mrad")):
            nees = np.mean([error @ np.linalg.solve(cov, error) / 3.0 for error, cov in (p[k] for p in parts)])
            rms = np.sqrt(np.mean([p[k][0] @ p[k][0] / 3.0 for p in parts]))
            sigma = np.sqrt(np.mean([np.trace(p[k][1]) / 3.0 for p in parts]))
            text.append(f"NEES {nees:.2f}, error {1e3 * rms:.2f} {unit}, sigma {1e3 * sigma:.2f} {unit}")
        print(f"{dataset}, {name}: translation {text[0]}; rotation {text[1]}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("datasets", nargs="+")
    parser.add_argument("--algorithm", default="arena_lio")
    arguments = parser.parse_args()
    for dataset in arguments.datasets:
        report(dataset, arguments.algorithm)


if __name__ == "__main__":
    main()
