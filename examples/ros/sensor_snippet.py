#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Prints a sensor of Lidarena with its Gazebo plugin, for a robot's description.

usage: sensor_snippet.py SENSOR [FORM] [--link LINK] [--lidarena PROGRAM]

SENSOR is a name of configs/sensors or a file. FORM:
  gz       SDF for gz-sim: a <sensor> to put into the <link> that carries it (default)
  classic  the same for Gazebo Classic 11
  xacro    a link, its joint and its sensor for a URDF, for gz-sim
  urdf     the same for Gazebo Classic
The mounting and the ranges are those of the sensor's file. LINK is the robot's link (base_link).
"""
import argparse
import json
import math
import subprocess
from xml.sax.saxutils import escape


def angles(q):
    """Roll, pitch, yaw of the quaternion x, y, z, w: R = Rz(yaw) Ry(pitch) Rx(roll)."""
    x, y, z, w = q
    sine = max(-1.0, min(1.0, 2 * (w * y - z * x)))
    if abs(sine) > 1 - 1e-12:  # looks straight up or down: roll is 0
        return [0.0, math.copysign(math.pi / 2, sine), math.copysign(2, -sine) * math.atan2(x, w)]
    return [math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)), math.asin(sine),
            math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))]


def words(values):
    return " ".join(f"{v + 0.0:.9g}" for v in values)


def sensor_sdf(sensor, classic, pose, sensor_word):
    """The <sensor> of SDF; its pose is that in the link."""
    pose_line = f"  <pose>{pose}</pose>\n" if pose else ""
    if not classic:
        return (f'<sensor name="{sensor["name"]}" type="custom">\n{pose_line}'
                '  <always_on>1</always_on>\n'
                '  <plugin filename="LidarenaGzLidar" name="lidarena::Lidar">\n'
                f'    <sensor>{sensor_word}</sensor>\n    <ros>on</ros>\n  </plugin>\n</sensor>\n')
    return (f'<sensor name="{sensor["name"]}" type="ray">\n{pose_line}'
            f'  <always_on>1</always_on>\n  <update_rate>{sensor["rate_hz"]:g}</update_rate>\n  <ray>\n'
            '    <scan><horizontal><samples>1</samples><min_angle>0</min_angle><max_angle>0</max_angle>'
            '</horizontal></scan>\n'
            f'    <range><min>{sensor["min_range_m"]:g}</min><max>{sensor["max_range_m"]:g}</max></range>\n'
            '  </ray>\n  <plugin name="lidarena" filename="libLidarenaLidar.so">\n'
            f'    <sensor>{sensor_word}</sensor>\n  </plugin>\n</sensor>\n')


def urdf(sensor, classic, link, xyz, rpy, sensor_word):
    """A link of its own with a fixed joint, which must not be lumped into the robot's link."""
    name = sensor["name"]
    inner = "".join(f"    {line}\n" for line in sensor_sdf(sensor, classic, "", sensor_word).splitlines())
    return (f'<robot name="{name}" xmlns:xacro="http://www.ros.org/wiki/xacro">\n'
            f'  <link name="{name}_lidar">\n'
            '    <inertial><mass value="0.3"/><inertia ixx="2e-4" ixy="0" ixz="0" iyy="2e-4" iyz="0" izz="2e-4"/>'
            '</inertial>\n  </link>\n'
            f'  <joint name="{name}_mount" type="fixed">\n    <parent link="{link}"/>\n'
            f'    <child link="{name}_lidar"/>\n    <origin xyz="{xyz}" rpy="{rpy}"/>\n  </joint>\n'
            f'  <gazebo reference="{name}_mount"><preserveFixedJoint>true</preserveFixedJoint></gazebo>\n'
            f'  <gazebo reference="{name}_lidar">\n{inner}  </gazebo>\n</robot>\n')


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sensor")
    parser.add_argument("form", nargs="?", default="gz", choices=("gz", "classic", "xacro", "urdf"))
    parser.add_argument("--link", default="base_link")
    parser.add_argument("--lidarena", default="lidarena")
    given = parser.parse_args()
    sensor = json.loads(subprocess.run([given.lidarena, "info", given.sensor, "--json"], check=True,
                                       stdout=subprocess.PIPE).stdout)
    pose = sensor["body_from_lidar"]
    xyz, rpy = words(pose[:3]), words(angles(pose[3:]))
    sensor_word = escape(given.sensor)
    if given.form in ("gz", "classic"):
        print(sensor_sdf(sensor, given.form == "classic", f"{xyz} {rpy}", sensor_word), end="")
    else:
        print(urdf(sensor, given.form == "urdf", given.link, xyz, rpy, sensor_word), end="")


if __name__ == "__main__":
    main()
