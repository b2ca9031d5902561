#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes range images of a Velodyne HDL-64E as a folder of sweeps that `lidarena run` reads.

usage: karlsruhe_to_dataset.py FOLDER OUT
FOLDER has scanNNNNN.png (64 x 870, 16 bit, range in m = value / 500, 0 = no return), img.cfg with the
pitch of each row (rad or deg, positive = down), mask.png (own car), gps_ins.tum. OUT gets NNNNNN.ply
and times.txt. Motion within a sweep is removed in the images, so points have no times.
"""
import math
import pathlib
import re
import struct
import sys
import zlib

METERS_PER_UNIT = 1 / 500


def read_png(path):
    """Width, height and rows of a grey PNG image, 8 or 16 bits, not interlaced."""
    data = path.read_bytes()
    place, packed = 8, b""
    while place < len(data):
        length, kind = struct.unpack(">I4s", data[place:place + 8])
        body = data[place + 8:place + 8 + length]
        if kind == b"IHDR":
            width, height, depth, color = struct.unpack(">IIBB", body[:10])
            assert color == 0, path
        if kind == b"IDAT":
            packed += body
        place += 12 + length
    size = max(depth // 8, 1)
    stride = width * depth // 8 + (1 if width * depth % 8 else 0)
    raw, rows, before = zlib.decompress(packed), [], bytearray(stride)
    for y in range(height):
        begin = y * (stride + 1)
        row, filtering = bytearray(raw[begin + 1:begin + 1 + stride]), raw[begin]
        for i in range(stride):
            left = row[i - size] if i >= size else 0
            up, corner = before[i], before[i - size] if i >= size else 0
            if filtering == 1:
                add = left
            elif filtering == 2:
                add = up
            elif filtering == 3:
                add = (left + up) // 2
            elif filtering == 4:
                guess = left + up - corner
                add = min((left, up, corner), key=lambda v: abs(guess - v))
            else:
                add = 0
            row[i] = (row[i] + add) & 255
        before = row
        if depth == 16:
            rows.append([row[2 * x] << 8 | row[2 * x + 1] for x in range(width)])
        elif depth == 8:
            rows.append(list(row))
        else:
            rows.append([row[x * depth // 8] >> (8 - depth - x * depth % 8) & (1 << depth) - 1 for x in range(width)])
    return width, height, rows


def pitches(path, count):
    numbers = [float(v) for v in re.findall(r"[-+]?\d+\.\d+(?:[eE][-+]?\d+)?|[-+]?\d+", path.read_text())]
    found = numbers[-count:]
    scale = math.pi / 180 if max(map(abs, found)) > 1 else 1.0
    return [scale * pitch for pitch in found]


def main():
    folder, out = map(pathlib.Path, sys.argv[1:3])
    out.mkdir(parents=True, exist_ok=True)
    images = sorted(folder.glob("scan*.png"))
    stamps = [line.split()[0] for line in (folder / "gps_ins.tum").read_text().splitlines() if line and line[0] != "#"]
    _, _, mask = read_png(folder / "mask.png")
    width, height, _ = read_png(images[0])
    pitch = pitches(folder / "img.cfg", height)
    for k, image in enumerate(images):
        points = bytearray()
        _, _, rows = read_png(image)
        count = 0
        for y, row in enumerate(rows):
            for x, value in enumerate(row):
                if value == 0 or mask[y][x] == 0:
                    continue
                distance = value * METERS_PER_UNIT
                azimuth = math.pi - 2 * math.pi * (x + 0.5) / width
                level = distance * math.cos(pitch[y])
                points += struct.pack("<fffH", level * math.cos(azimuth), level * math.sin(azimuth), -distance * math.sin(pitch[y]), y)
                count += 1
        head = (
            "ply\nformat binary_little_endian 1.0\n"
            f"element vertex {count}\nproperty float x\nproperty float y\nproperty float z\nproperty ushort ring\nend_header\n"
        )
        (out / f"{k:06d}.ply").write_bytes(head.encode() + points)
    (out / "times.txt").write_text("\n".join(stamps[:len(images)]) + "\n")


main()
