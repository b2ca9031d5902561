#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Whether a method names the scans that leave a direction undetermined.

usage: PYTHONPATH=build/release/python degenerate_truth.py DATASET... [--algorithm arena_lio] [--scans]

A scan is degenerate in truth if its standard deviation exceeds 5 cm or 1 degree in some direction. It follows from the
hits that the simulator has written beside the scans: the true surface points with the normals of the mesh, seen from
the true pose, with 2 cm of noise along each normal. Prints for each dataset how many scans are, the share of these
that the method calls degenerate, and the share of the others that it calls so. --scans prints each scan.
"""
import argparse
import pathlib
import struct

import numpy as np

import lidarena

NOISE_M = 0.02
MAX_TRANSLATION_M = 0.05
MAX_ROTATION_RAD = np.radians(1.0)
HAS_CLASSES = 1 << 63


def hits_of(file):
    """[(stamp, positions and normals in the world, n x 6)] of each scan."""
    data = pathlib.Path(file).read_bytes()
    at = len(b"lidarena hits 1\n")
    while at < len(data):
        stamp, returns = struct.unpack_from("<qQ", data, at)
        count = returns & ~HAS_CLASSES
        hits = np.frombuffer(data, "<f4", 6 * count, at + 16).reshape(count, 6).astype(float)
        at += 16 + 24 * count + (4 * count if returns & HAS_CLASSES else 0)
        yield stamp, hits


def deviations(hits, sensor, returns):
    """Largest standard deviation of position (m) and rotation (rad) of a scan of so many returns."""
    if len(hits) < 6:
        return np.inf, np.inf
    arms, normals = hits[:, :3] - sensor, hits[:, 3:]
    rows = np.hstack([normals, np.cross(arms, normals)])
    information = rows.T @ rows * (returns / len(hits)) / NOISE_M**2
    covariance = np.linalg.inv(information + 1e-9 * np.eye(6))
    return tuple(np.sqrt(np.linalg.eigvalsh(block)[-1]) for block in (covariance[:3, :3], covariance[3:, 3:]))


def report(dataset, algorithm, scans):
    source = lidarena.open_dataset(dataset)
    lidar = source.rig.lidars[0]
    odometry = lidarena.make_odometry(source.rig, algorithm, threads=1)
    truth = lidarena.load_truth(dataset)
    flight, begin = lidarena.replay(truth), int(truth.stamps[0])
    hits = hits_of(pathlib.Path(dataset) / (lidar["id"] + "_hits.bin"))
    rows = []
    for _, data in source:
        if isinstance(data, lidarena.ImuSample):
            odometry.register_imu(data)
            continue
        result = odometry.register_scan(data)
        stamp, surface = next(hits)
        assert stamp == data.stamp, "hits and scans differ"
        middle = stamp + int(0.5e9 / lidar["rate_hz"]) - begin
        if not 0 <= middle <= flight.duration:
            continue
        body = flight.at(middle).pose
        sensor = body[:3, :3] @ lidar["body_from_lidar"][:3] + body[:3, 3]
        translation, rotation = deviations(surface, sensor, len(data))
        truly = translation > MAX_TRANSLATION_M or rotation > MAX_ROTATION_RAD
        rows.append((truly, result.status == "degenerate"))
        if scans:
            print(f"{1e-9 * (stamp - begin):.2f} s: {1e2 * translation:.3g} cm, {np.degrees(rotation):.3g} deg, "
                  f"{len(surface)} hits, {len(data)} returns, {result.status} {result.counters}", flush=True)
    truly, named = np.array(rows).T
    share = lambda which: f"{np.mean(named[which]):.3f}" if which.any() else "none"
    print(f"{dataset}: {truly.sum()} of {len(rows)} scans degenerate; named of these {share(truly)}, "
          f"of the others {share(~truly)}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("datasets", nargs="+")
    parser.add_argument("--algorithm", default="arena_lio")
    parser.add_argument("--scans", action="store_true")
    arguments = parser.parse_args()
    for dataset in arguments.datasets:
        report(dataset, arguments.algorithm, arguments.scans)


if __name__ == "__main__":
    main()
