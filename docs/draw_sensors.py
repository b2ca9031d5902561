#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Draws each sensor's shots by direction as docs/images/sensor_NAME.png. usage: draw_sensors.py

Azimuth 180 to -180 deg from left to right, elevation 90 to -90 deg from top to bottom, half a degree
per pixel; top: the first 0.1 s, bottom: the first 1 s; the darker a pixel, the more shots.
"""
import pathlib
import struct
import zlib

import numpy as np

import lidarena

STEP = 0.5  # deg per pixel


def panel(lidar, seconds):
    """Gray values from the number of shots in each pixel."""
    scans = max(1, round(seconds * 1e9 / lidar.period))
    counts = np.zeros((int(180 / STEP), int(360 / STEP)))
    for index in range(scans):
        x, y, z = lidar.beams(index)["direction"].astype(float).T
        column = np.clip((180 - np.degrees(np.arctan2(y, x))) / STEP, 0, counts.shape[1] - 1)
        row = np.clip((90 - np.degrees(np.arcsin(np.clip(z, -1, 1)))) / STEP, 0, counts.shape[0] - 1)
        np.add.at(counts, (row.astype(int), column.astype(int)), 1)
    seen = np.where(counts > 0, 0.25 + 0.75 * np.minimum(1, counts / 8), 0)
    gray = (255 * (1 - seen)).astype(np.uint8)
    gray[[0, -1], :], gray[:, [0, -1]] = 160, 160
    return gray


def write_png(file, gray):
    def chunk(kind, data):
        return (struct.pack(">I", len(data)) + kind + data +
                struct.pack(">I", zlib.crc32(kind + data)))
    rows = b"".join(b"\0" + row.tobytes() for row in gray)
    header = struct.pack(">IIBBBBB", gray.shape[1], gray.shape[0], 8, 0, 0, 0, 0)
    file.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) +
                     chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b""))


images = pathlib.Path(__file__).parent / "images"
for name in lidarena.configs.names("sensors"):
    if name.endswith(("_paper", "_full")) or "1024x20" in name or "512" in name:
        continue  # same pattern, or a thinned one, as a sensor that is drawn
    lidar = lidarena.Lidar(lidarena.load_sensor(name))
    picture = np.vstack([panel(lidar, 0.1), panel(lidar, 1.0)])
    write_png(images / f"sensor_{name}.png", picture)
    print(name)
