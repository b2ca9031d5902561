#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""examples/ros: snippets of every sensor are valid XML with the sensor's ranges and mounting; RViz's
and Foxglove's files name topics that a dataset has.

usage: ros_examples.py PROGRAM EXAMPLES CONFIGS
"""
import json
import math
import pathlib
import re
import subprocess
import sys
import xml.etree.ElementTree as ElementTree

PROGRAM, EXAMPLES, CONFIGS = (pathlib.Path(argument).resolve() for argument in sys.argv[1:4])
SCRIPT = EXAMPLES / "ros/sensor_snippet.py"
TOPICS = {"/livox_mid360/points", "/livox_mid360/imu", "/truth/odometry"}
sys.path.insert(0, str(EXAMPLES / "ros"))
sys.dont_write_bytecode = True
import sensor_snippet  # noqa: E402


def matrix(q):
    x, y, z, w = q
    return [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w),
            2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
            2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]


def turned(roll, pitch, yaw):
    """The rotation of roll about x, then pitch about y, then yaw about z, by rows."""
    a, b = math.cos(roll), math.sin(roll)
    c, d = math.cos(pitch), math.sin(pitch)
    e, f = math.cos(yaw), math.sin(yaw)
    return [e * c, e * d * b - f * a, e * d * a + f * b, f * c, f * d * b + e * a, f * d * a - e * b,
            -d, c * b, c * a]


def near(a, b, tolerance=1e-7):
    return len(a) == len(b) and all(abs(x - y) < tolerance for x, y in zip(a, b))


def snippet(name, form):
    words = [sys.executable, SCRIPT, name, form, "--link", "arm", "--lidarena", PROGRAM]
    return ElementTree.fromstring(subprocess.run(words, cwd=CONFIGS.parent, check=True, capture_output=True).stdout)


for quaternion in ([0.5, 0.5, -0.5, 0.5], [0.1, -0.7, 0.1, 0.7], [0, 0, 1, 0], [0, 0.6, 0, 0.8],
                   [0, math.sqrt(0.5), 0, math.sqrt(0.5)], [0.5, -0.5, 0.5, 0.5]):
    assert near(turned(*sensor_snippet.angles(quaternion)), matrix(quaternion)), quaternion

names = sorted(file.stem for file in (CONFIGS / "sensors").glob("*.yaml"))
assert len(names) > 20
for name in names:
    sensor = json.loads(subprocess.run(
        [PROGRAM, "info", name, "--json"], cwd=CONFIGS.parent, check=True, capture_output=True).stdout)
    mounting = sensor["body_from_lidar"]
    classic = snippet(name, "classic")
    assert classic.find("plugin").get("filename") == "libLidarenaLidar.so"
    assert classic.find("plugin/sensor").text == name
    assert near([float(classic.find(f"ray/range/{end}").text) for end in ("min", "max")],
                [sensor["min_range_m"], sensor["max_range_m"]], 1e-4), name
    pose = [float(v) for v in classic.find("pose").text.split()]
    assert near(pose[:3], mounting[:3]) and near(turned(*pose[3:]), matrix(mounting[3:])), (name, pose)
    if name not in ("livox_mid360", "ouster_os0_128", "velodyne_vlp16"):
        continue  # the other forms differ in the frame around the sensor alone
    assert snippet(name, "gz").find("plugin").get("name") == "lidarena::Lidar"
    for form, kind in (("xacro", "custom"), ("urdf", "ray")):
        robot = snippet(name, form)
        link = robot.find("link").get("name")
        assert robot.find("joint/child").get("link") == link and robot.find("joint/parent").get("link") == "arm"
        origin = robot.find("joint/origin")
        assert near([float(v) for v in origin.get("xyz").split()], mounting[:3])
        assert near(turned(*[float(v) for v in origin.get("rpy").split()]), matrix(mounting[3:]))
        held = [g for g in robot.findall("gazebo") if g.get("reference") == link]
        assert held[0].find("sensor").get("type") == kind and held[0].find("sensor/pose") is None

named = set(re.findall(r"(/(?:livox_mid360|truth)/\w+)", (EXAMPLES / "ros/foxglove.json").read_text()))
assert named == TOPICS, named
layout = json.loads((EXAMPLES / "ros/foxglove.json").read_text())
assert set(re.findall(r"\w+!\w+", json.dumps(layout["layout"]))) == set(layout["configById"])
rviz = (EXAMPLES / "ros/play.rviz").read_text()
assert set(re.findall(r"Value: (/\w+/\w+)", rviz)) <= TOPICS
try:
    import yaml
    assert len(yaml.safe_load(rviz)["Visualization Manager"]["Displays"]) == 4
except ImportError:
    print("skipped: the form of play.rviz, since python3-yaml is not installed")
