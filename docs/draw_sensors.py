#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes docs/sensor_pictures.md and its pictures. usage: draw_sensors.py PROGRAM

docs/images/sensor_NAME.png shows a sensor's shots by direction: azimuth 180 to -180 deg from left to right, elevation 90 to -90 deg from top to bottom, half a degree
per pixel; top: the first 0.1 s, bottom: the first 1 s; the darker a pixel, the more shots.
"""
import json
import pathlib
import struct
import subprocess
import sys
import zlib

import numpy as np

import lidarena

STEP = 0.5  # deg per pixel
HEAD = """# Pictures of the sensors

Directions of each sensor's shots in its own frame: azimuth from 180 deg (left) to -180 deg (right), elevation from 90 deg to -90 deg. A
pixel is half a degree; the darker it is, the more shots. The upper picture shows the first 0.1 s, the lower one the first 1 s. If they
differ, the pattern does not repeat with every scan. The tables give the share of the field of view's solid angle that the shots have
covered. Its cells are 0.5 deg, or 0.25 deg where the field of view is narrower than 180 deg. `docs/draw_sensors.py` writes this page.
`lidarena info SENSOR --pattern --out FILE.svg` draws your own sensors and computes the same shares.
"""


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


def told_by(program, *arguments):
    return json.loads(subprocess.run([program, *arguments, "--json"], check=True,
                                     capture_output=True).stdout)


def draw(file, sensor):
    lidar = lidarena.Lidar(lidarena.load_sensor(sensor))
    write_png(file, np.vstack([panel(lidar, 0.1), panel(lidar, 1.0)]))


def section(program, sensor):
    name, summary = sensor["name"], sensor["summary"]
    pattern = told_by(program, "info", name, "--pattern")
    shares = pattern["coverage"]
    if "approximate" in pattern:
        summary += f" Approximate: {pattern['approximate']}."
    return "\n".join([f"\n## {name}\n", summary + "\n", "| covered in | " + " | ".join(shares) + " |",
                      "|---|" + "---:|" * len(shares),
                      "| | " + " | ".join(f"{100 * s:.1f} %" for s in shares.values()) + " |\n",
                      f"![Shots of {name} by direction](images/sensor_{name}.png)", ""])


docs = pathlib.Path(__file__).parent
page = HEAD
for listed in told_by(sys.argv[1], "list", "sensors"):
    if listed["name"].endswith(("_paper", "_full", "_vibrating", "_harsh")) or "1024x20" in listed["name"] or "512" in listed["name"]:
        continue  # same pattern, or a thinned one, as a sensor that is drawn
    draw(docs / "images" / f"sensor_{listed['name']}.png", listed["name"])
    page += section(sys.argv[1], listed)
(docs / "sensor_pictures.md").write_text(page)
