#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Draws the worlds by seed, people in a map, and a wall with biased ranges.

usage: PYTHONPATH=build/release/python draw_worlds.py PROGRAM FOLDER

Writes worlds_by_seed.png (mine, forest, hall and office of three seeds, from above, with the route), people_in_map.png (returns of a flight placed by
the truth, movers in red) and biased_wall.png (a cross section of a wall's returns, clean and with the errors of `noise.bias`) to FOLDER.
"""
import pathlib
import subprocess
import sys
import tempfile

import matplotlib
import numpy as np

import lidarena

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

KINDS, SEEDS = ("mine", "forest", "hall", "office"), (9101, 9102, 9103)
AIR_AND_GHOSTS = 0xFFFFFFFD  # and above: classes that are no triangle
BIAS = "{unit_m: 0.005, channel_m: 0.003, incidence_m: 0.01, reflectivity_m: 0.01, direction_deg: 0.03}"


def simulate(program, out, world, flight, seconds, *options):
    subprocess.run([program, "simulate", "--world", world, "--flight", flight, "--sensor", "livox_mid360", "--seconds", str(seconds),
                    "--out", out, "-q", *options], check=True, stdout=subprocess.DEVNULL)
    return out


def surface(world, count, random):
    """Points on the triangles, evenly by area."""
    corners = np.asarray(world.vertices)[np.asarray(world.triangles)]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    picked = corners[random.choice(len(area), count, p=area / area.sum())]
    u, v = np.sqrt(random.random((count, 1))), random.random((count, 1))
    return (1 - u) * picked[:, 0] + u * (1 - v) * picked[:, 1] + u * v * picked[:, 2]


def draw_worlds(program, folder, image):
    figure, axes = plt.subplots(len(KINDS), len(SEEDS), figsize=(12, 13.5))
    random = np.random.default_rng(1)
    for row, kind in zip(axes, KINDS):
        for axis, seed in zip(row, SEEDS):
            dataset = simulate(program, folder / f"{kind}{seed}", f"dev_{kind}", f"{kind}_aggressive", 60, "--new-scene", "--seed", str(seed),
                               "--no-data", "--hits", "off")
            points = surface(lidarena.load_world(dataset / "world.ply"), 400_000, random)
            path = np.asarray(lidarena.load_truth(dataset).positions)
            points = points[points[:, 2] < path[:, 2].max() + 0.3]  # without roofs and crowns
            points = points[np.argsort(points[:, 2])]
            axis.scatter(points[:, 0], points[:, 1], c=points[:, 2], s=0.1, cmap="viridis", rasterized=True)
            axis.plot(path[:, 0], path[:, 1], color="red", linewidth=1)
            axis.set(aspect="equal", title=f"{kind}, seed {seed}")
            axis.tick_params(labelsize=7)
    figure.suptitle("Surfaces below the flight's highest point, by height; red: 60 s of the route; m")
    figure.tight_layout()
    figure.savefig(image, dpi=60)


HIT = [("position", "<f4", 3), ("range_and_normal", "<f4", 4), ("triangle", "<u4")]  # in the world, by the truth
POINT = [("position", "<f4", 3), ("intensity", "<f4"), ("t", "<u4"), ("ring", "<u2"), ("echo", "u1")]  # in the LiDAR's frame


def read_pcd(files, layout):
    marks = [(data, data.index(b"DATA binary\n") + 12) for data in (file.read_bytes() for file in sorted(files))]
    return np.concatenate([np.frombuffer(data[begin:], dtype=layout) for data, begin in marks])


def draw_people(program, folder, image):
    dataset = simulate(program, folder / "people", "dev_hall", "hall_aggressive", 20, "--new-scene", "--seed", "9101", "--set", "world.people=8",
                       "--format", "pcd", "--truth")
    returns = read_pcd(dataset.glob("livox_mid360/hits/*.pcd"), HIT)
    triangles = len(lidarena.load_world(dataset / "world.ply").triangles)
    moving = (returns["triangle"] >= triangles) & (returns["triangle"] < AIR_AND_GHOSTS)  # triangles of movers follow those of the world
    figure, axis = plt.subplots(figsize=(10, 7))
    low = (returns["position"][:, 2] > 0.2) & (returns["position"][:, 2] < 2.2)
    for mask, color, size in ((low & ~moving, "0.6", 0.05), (low & moving, "red", 0.8)):
        axis.scatter(*returns["position"][mask][:, :2].T, c=color, s=size, rasterized=True)
    axis.set(aspect="equal", title="A hall, 20 s of a Mid-360: returns between 0.2 and 2.2 m, people in red")
    figure.tight_layout()
    figure.savefig(image, dpi=80)


def draw_bias(program, folder, image):
    corners = ((3, -4, -1), (3, 4, -1), (3, 4, 4), (3, -4, 4))
    (folder / "wall.obj").write_text("".join(f"v {x} {y} {z}\n" for x, y, z in corners) + "f 1 4 3 2\n")
    (folder / "hover.yaml").write_text("kind: waypoints\nwaypoints: [[0, 0, 1.5], [0.3, 0, 1.5]]\nclearance_m: 0\n")
    figure, axis = plt.subplots(figsize=(10, 4))
    for name, bias, color in (("without", "{unit_m: 0}", "0.5"), ("with", BIAS, "tab:red")):
        dataset = simulate(program, folder / f"wall_{name}", folder / "wall.obj", folder / "hover.yaml", 1, "--format", "pcd", *(
            f"--set=sensor.{key}" for key in ("imu=null", "range_noise_m=0", "noise.near_range_noise_m=0", "noise.angle_noise_deg=0",
                                              f"noise.bias={bias}")))
        positions = read_pcd(dataset.glob("livox_mid360/*.pcd"), POINT)["position"]  # it hovers: axes and x are the world's
        positions = positions[(positions[:, 0] > 2) & (np.abs(positions[:, 2]) < 0.4)]
        axis.scatter(positions[:, 1], 100 * (positions[:, 0] - 3.0), s=1, c=color, label=f"{name} bias")
    axis.set(xlabel="along the wall, m", ylabel="behind the wall, cm", title="Returns of a flat wall at 3 m, no range noise")
    axis.legend(markerscale=6)
    figure.tight_layout()
    figure.savefig(image, dpi=80)


def main(program, images):
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        draw_worlds(program, folder, images / "worlds_by_seed.png")
        draw_people(program, folder, images / "people_in_map.png")
        draw_bias(program, folder, images / "biased_wall.png")


main(sys.argv[1], pathlib.Path(sys.argv[2]))
