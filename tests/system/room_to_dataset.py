#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""A synthetic room becomes a dataset that the program reads: points, times, IMU, extrinsics, truth.

usage: room_to_dataset.py PROGRAM SCRIPT
"""
import json
import math
import pathlib
import struct
import subprocess
import sys
import tempfile

PROGRAM, SCRIPT = sys.argv[1:3]


def write_room(room):
    (room / "scans").mkdir(parents=True)
    half = math.sqrt(0.5)  # the LiDAR is turned by 90 degrees about z and sits 0.1 m above the body
    (room / "meta.json").write_text(json.dumps({
        "columns": ["x", "y", "z", "t", "ring"], "body_from_lidar": [0, 0, 0.1, 0, 0, half, half],
        "time": "absolute seconds", "truth": "lidar frame"}))
    (room / "scans.txt").write_text("0 100.0 100.1\n1 100.1 100.2\n")
    for scan in range(2):
        rows = [(1.0 + i, 2.0, 3.0, 100.0 + 0.1 * scan + 0.01 * i, i) for i in range(4)]
        (room / "scans" / f"{scan:06d}.bin").write_bytes(b"".join(struct.pack("<5d", *row) for row in rows))
    (room / "imu.txt").write_text("".join(f"{100 + 0.005 * i:.9f} 0 0 0.1 0 0 9.8\n" for i in range(41)))
    # the LiDAR looks along the world's x, so the body looks along -y
    (room / "gt.tum").write_text("100.0 5 6 7.1 0 0 0 1\n100.2 6 6 7.1 0 0 0 1\n")


def near(a, b, tolerance=1e-6):
    return len(a) == len(b) and all(abs(x - y) < tolerance for x, y in zip(a, b))


with tempfile.TemporaryDirectory() as folder:
    room, dataset = pathlib.Path(folder, "room"), pathlib.Path(folder, "dataset")
    write_room(room)
    subprocess.run([sys.executable, SCRIPT, room, dataset], check=True)
    half = math.sqrt(0.5)
    truth = [[float(x) for x in line.split()] for line in (dataset / "truth.tum").read_text().splitlines()]
    assert near(truth[0], [100.0, 5, 6, 7.0, 0, 0, -half, half]), truth
    assert near(truth[1], [100.2, 6, 6, 7.0, 0, 0, -half, half]), truth

    info = json.loads(subprocess.run([PROGRAM, "info", "--json", dataset], check=True, capture_output=True).stdout)
    lidar = info["rig"]["lidars"][0]
    assert near(lidar["body_from_lidar"], [0, 0, 0.1, 0, 0, half, half]), lidar
    assert abs(lidar["rate_hz"] - 10) < 1e-6, lidar
    assert abs(info["rig"]["imus"][0]["rate_hz"] - 200) < 1e-6, info["rig"]
    assert info["topics"]["lidar/points"]["points"] == 8, info["topics"]
    assert info["topics"]["imu/imu"]["messages"] == 41, info["topics"]

    # and back: what the program writes of it has the same points and times
    copy = pathlib.Path(folder, "copy")
    subprocess.run([PROGRAM, "convert", "--quiet", "--format", "pcd", dataset, copy], check=True)
    sweep = (copy / "lidar" / "000001.pcd").read_bytes()
    header, data = sweep.split(b"DATA binary\n", 1)
    fields = dict(line.split(" ", 1) for line in header.decode().splitlines() if " " in line)
    names = fields["FIELDS"].split()
    kinds = {"F4": "f", "U4": "I", "U2": "H", "U1": "B"}
    row = struct.Struct("<" + "".join(kinds[t + s] for t, s in zip(fields["TYPE"].split(), fields["SIZE"].split())))
    points = [dict(zip(names, values)) for values in row.iter_unpack(data)]
    for i, point in enumerate(points):
        assert (point["x"], point["y"], point["z"]) == (1.0 + i, 2.0, 3.0), point
        assert (point["t"], point["ring"]) == (10_000_000 * i, i), point
    assert len(points) == 4

    (room / "scans" / "000001.bin").write_bytes(b"cut short")
    broken = subprocess.run([sys.executable, SCRIPT, room, pathlib.Path(folder, "broken")], capture_output=True, text=True)
    assert broken.returncode != 0 and "cut short" in broken.stderr and "000001.bin" in broken.stderr, broken.stderr
print("a room becomes a dataset")
