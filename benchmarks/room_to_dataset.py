#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Converts a synthetic room, a sequence that our simulator did not make, to a dataset folder.

usage: room_to_dataset.py ROOM DATASET

ROOM holds
  meta.json       {"columns": ["x", "y", "z", "t", "ring"], "body_from_lidar": [x, y, z, qx, qy, qz, qw],
                  "truth": "imu frame" or "lidar frame"}
  scans.txt       rows: index t_begin t_end (s)
  scans/%06d.bin  rows of the columns as little-endian float64, m and s, each point in the LiDAR's
                  frame at its own instant t
  imu.txt         rows: t wx wy wz ax ay az (rad/s, specific force m/s^2); optional
  gt.tum          truth; optional
DATASET becomes a folder of PCD sweeps with one LiDAR ("lidar") and maybe one IMU ("imu") whose frame
is the body. A scan's stamp is its t_begin.
"""
import array
import json
import pathlib
import struct
import sys

NS = 1_000_000_000


def rows_of(file):
    for line in file.read_text().splitlines():
        if line.strip() and not line.startswith("#"):
            yield [float(word) for word in line.split()]


def nanoseconds(seconds):
    """Nearest integer; a float's error is below 1 ns for times below 10^6 s."""
    return round(seconds * NS)


def write_sweep(source, columns, begin, target):
    data, width = source.read_bytes(), len(columns)
    if len(data) % (8 * width):
        sys.exit(f"{source}: its size is no multiple of {width} columns; the file is cut short, or meta.json is wrong")
    values = array.array("d", data)
    if sys.byteorder == "big":
        values.byteswap()
    count = len(values) // width
    at = {name: values[i::width] for i, name in enumerate(columns)}
    rings = at.get("ring", [0] * count)
    offsets = [nanoseconds(t) - begin for t in at["t"]]
    if any(not 0 <= offset < 2**31 for offset in offsets):
        sys.exit(f"{source}: a point is earlier than its scan, or more than 2 s later")
    with target.open("wb") as out:
        out.write((f"VERSION 0.7\nFIELDS x y z t ring\nSIZE 4 4 4 4 2\nTYPE F F F U U\nCOUNT 1 1 1 1 1\nWIDTH {count}\nHEIGHT 1\n"
                   f"VIEWPOINT 0 0 0 1 0 0 0\nPOINTS {count}\nDATA binary\n").encode())
        row = struct.Struct("<fffIH")
        for x, y, z, offset, ring in zip(at["x"], at["y"], at["z"], offsets, rings):
            out.write(row.pack(x, y, z, offset, int(ring)))


def rotate(q, v):
    """Vector `v` rotated by the quaternion `q` (x, y, z, w)."""
    t = [2 * (q[(i + 1) % 3] * v[(i + 2) % 3] - q[(i + 2) % 3] * v[(i + 1) % 3]) for i in range(3)]
    return [v[i] + q[3] * t[i] + q[(i + 1) % 3] * t[(i + 2) % 3] - q[(i + 2) % 3] * t[(i + 1) % 3] for i in range(3)]


def product(a, b):
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return [aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz]


def body_truth(row, body_from_lidar):
    """A row of the LiDAR's trajectory as one of the body's: world_from_lidar * body_from_lidar^-1."""
    t, position, q = row[0], row[1:4], row[4:8]
    inverse = [-body_from_lidar[3], -body_from_lidar[4], -body_from_lidar[5], body_from_lidar[6]]
    back = rotate(inverse, [-x for x in body_from_lidar[:3]])
    moved = rotate(q, back)
    return [t, *(position[i] + moved[i] for i in range(3)), *product(q, inverse)]


def mean_rate(times, otherwise):
    return (len(times) - 1) / (times[-1] - times[0]) if len(times) > 1 else otherwise


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    room, out = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    meta = json.loads((room / "meta.json").read_text())
    extrinsics = meta["body_from_lidar"]
    scans = list(rows_of(room / "scans.txt"))
    (out / "lidar").mkdir(parents=True)
    for number, (index, begin, _) in enumerate(scans):
        write_sweep(room / "scans" / f"{int(index):06d}.bin", meta["columns"], nanoseconds(begin),
                    out / "lidar" / f"{number:06d}.pcd")
    begins = [row[1] for row in scans]
    (out / "lidar" / "times.txt").write_text("".join(f"{t:.9f}\n" for t in begins))
    rig = {"body_frame": "body", "imus": [],
           "lidars": [{"id": "lidar", "rate_hz": mean_rate(begins, 10.0), "body_from_lidar": extrinsics}]}
    counts = {}
    if (room / "imu.txt").exists():
        samples = [line for line in (room / "imu.txt").read_text().splitlines() if line and not line.startswith("#")]
        (out / "imu").mkdir()
        (out / "imu" / "imu.txt").write_text("\n".join(samples) + "\n")
        rig["imus"] = [{"id": "imu", "rate_hz": mean_rate([float(s.split()[0]) for s in samples], 200.0)}]
        counts = {"imu": len(samples)}
    if (room / "gt.tum").exists():
        rows = list(rows_of(room / "gt.tum"))
        if meta.get("truth", "imu frame") == "lidar frame":
            rows = [body_truth(row, extrinsics) for row in rows]
        (out / "truth.tum").write_text("".join(f"{r[0]:.9f} " + " ".join(f"{x:.9g}" for x in r[1:8]) + "\n" for r in rows))
    (out / "manifest.json").write_text(json.dumps({
        "format": "lidarena dataset", "format_version": 1, "kind": "dataset", "storage": "pcd", "dialect": "si", "rig": rig,
        "scan_counts": {"lidar": len(scans)}, "imu_counts": counts, "hit_counts": {}}, indent=1) + "\n")
    print(f"{out}: {len(scans)} scans, {sum(counts.values())} IMU samples")


if __name__ == "__main__":
    main()
