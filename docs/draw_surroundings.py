#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Draws what panes, fog and retroreflectors do to a LiDAR. usage: draw_surroundings.py PROGRAM FOLDER

Writes pane_ghosts.png, fog.png and blooming.png to FOLDER: gray points are of surfaces, red ones ghosts and halos, blue ones of the air,
the green dot is the sensor. Returns are placed by their truth.
"""
import math
import pathlib
import struct
import subprocess
import sys
import tempfile
import zlib

AIR, GHOST = 0xFFFFFFFE, 0xFFFFFFFD
SIZE = (640, 420)  # pixels
COLORS = {AIR: (40, 90, 220), GHOST: (210, 30, 30)}
GRAY, GREEN, WHITE = (110, 110, 110), (20, 150, 60), (255, 255, 255)


def write_png(file, pixels):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    rows = b"".join(b"\0" + bytes(sum(row, ())) for row in pixels)
    header = struct.pack(">IIBBBBB", *SIZE, 8, 2, 0, 0, 0)
    file.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b""))


def box(low, high):
    return [[(high if corner >> axis & 1 else low)[axis] for axis in range(3)] for corner in range(8)]


FACES = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))


def write_world(file, boxes):
    """boxes: (low, high, index of the material)."""
    vertices, faces = [], []
    for low, high, material in boxes:
        faces += [(material, [len(vertices) + corner for corner in face]) for face in FACES]
        vertices += box(low, high)
    lines = ["ply", "format ascii 1.0", "comment material 0.6 0 wall", "comment material 0.08 0.95 transmission=0.9 glass",
             "comment material 0.5 0 retro=800 sign", f"element vertex {len(vertices)}", "property float x", "property float y",
             "property float z", f"element face {len(faces)}", "property uchar material_index", "property list uchar int vertex_indices",
             "end_header"]
    lines += [" ".join(map(str, vertex)) for vertex in vertices]
    lines += [f"{material} 4 " + " ".join(map(str, corners)) for material, corners in faces]
    file.write_text("\n".join(lines) + "\n")


def simulate(program, folder, world, flight, sensor, seconds, settings):
    """Position (m, world) and class of each return."""
    out = folder / world.stem
    subprocess.run([program, "simulate", "--world", world, "--flight", flight, "--sensor", sensor, "--set", "sensor.imu=null",
                    *(f"--set=sensor.{setting}" for setting in settings), "--seconds", seconds, "--format", "pcd", "--truth", "--out", out],
                   check=True, stdout=subprocess.DEVNULL)
    returns = []
    for file in sorted(out.rglob("hits/*.pcd")):
        data = file.read_bytes()
        rows = struct.iter_unpack("<7fI", data[data.index(b"DATA binary\n") + 12:])
        returns += [(row[0:3], row[7]) for row in rows]
    return returns


def draw(file, returns, project, sensor):
    """project: pixel of a position, or None."""
    pixels = [[WHITE] * SIZE[0] for _ in range(SIZE[1])]
    def mark(pixel, color, half):
        column, row = round(pixel[0]), round(pixel[1])
        for y in range(row - half, row + half + 1):
            for x in range(column - half, column + half + 1):
                if 0 <= x < SIZE[0] and 0 <= y < SIZE[1]:
                    pixels[y][x] = color
    for kinds in ((GRAY,), COLORS.values()):  # the classes on top
        for position, triangle in returns:
            color = COLORS.get(triangle, GRAY)
            pixel = project(position)
            if color in kinds and pixel:
                mark(pixel, color, 1)
    if sensor:
        mark(sensor, GREEN, 4)
    write_png(file, pixels)


def from_above(center, scale, heights):
    def project(p):
        if not heights[0] < p[2] < heights[1]:
            return None
        return SIZE[0] / 2 + scale * (p[0] - center[0]), SIZE[1] / 2 - scale * (p[1] - center[1])
    return project


def from_sensor(sensor, degrees):
    """Azimuth and elevation around +x."""
    def project(p):
        x, y, z = (p[i] - sensor[i] for i in range(3))
        scale = SIZE[0] / math.radians(degrees)
        if x <= 0:
            return None
        return SIZE[0] / 2 - scale * math.atan2(y, x), SIZE[1] / 2 - scale * math.atan2(z, math.hypot(x, y))
    return project


def main(program, images):
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        flight = folder / "flight.yaml"
        flight.write_text("kind: waypoints\nwaypoints: [[0, 0, 1.5], [0.3, 0, 1.5]]\nclearance_m: 0\n")
        room = folder / "room.ply"
        write_world(room, [((-5, -4, -0.1), (9, 4, 0), 0), ((-5.1, -4, 0), (-5, 4, 3), 0), ((-5, -4.1, 0), (3, -4, 3), 0),
                           ((-5, 4, 0), (3, 4.1, 3), 0), ((3, -4, 0), (3.01, 4, 3), 1), ((-1, 1, 0), (0.5, 2, 1.8), 0),
                           ((-3, -3, 0), (-2, -2, 2), 0), ((5.5, -2, 0), (6.5, -1, 2), 0)])
        project = from_above((2.5, 0), 40, (0.3, 2.8))
        returns = simulate(program, folder, room, flight, "livox_mid360", "1", ["noise.bounces=4", "returns.choice=last"])
        draw(images / "pane_ghosts.png", returns, project, project((0, 0, 1.5)))
        house = pathlib.Path(__file__).parent.parent / "configs/worlds/house.yaml"
        route = folder / "route.yaml"
        route.write_text("kind: route\n")
        returns = simulate(program, folder, house, route, "livox_mid360", "1", ["noise.air.visibility_m=10"])
        draw(images / "fog.png", returns, from_above((3.5, 3), 36, (0, 2.2)), None)
        hall = folder / "hall.ply"
        write_world(hall, [((-20, -15, 0), (25, 15, 8), 0), ((8, -0.4, 1.1), (8.05, 0.4, 1.9), 2), ((8.05, -0.05, 0), (8.1, 0.05, 1.9), 0)])
        returns = simulate(program, folder, hall, flight, "ouster_os0_128_2048", "0.2", ["noise.blooming.share=0.01", "noise.blooming.rays=16"])
        draw(images / "blooming.png", returns, from_sensor((0, 0, 1.6), 30), None)


main(sys.argv[1], pathlib.Path(sys.argv[2]))
