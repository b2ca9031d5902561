#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes the parameters of a SLAM program from the LiDAR and IMU of a recording.

usage: parameters.py PROGRAM RIG OUT [--noise program|sensor]

PROGRAM: fast_lio2 (ROS 1), fast_lio2_ros2, lio_sam (ROS 1), dlio (ROS 2) or glim. RIG is the file
that {rig} of a command line names. OUT is the file to write, of glim its folder of configuration.
--noise: the densities of the IMU's noise that the program ships (default), or the sensor's own.

The files are JSON, which is also YAML. Settings that are not named here keep the program's defaults.
"""
import argparse
import json
import math
import pathlib
import sys


def rows_of(q):
    """Matrix of the quaternion x, y, z, w, by rows."""
    x, y, z, w = q
    return [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w),
            2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
            2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]


def turned(rows, v):
    return [sum(rows[3 * i + j] * v[j] for j in range(3)) for i in range(3)]


def times(p, q):
    """Quaternion of the rotation q followed by p; x, y, z, w."""
    a, b, c, d = p
    e, f, g, h = q
    return [d * e + a * h + b * g - c * f, d * f - a * g + b * h + c * e,
            d * g + a * f - b * e + c * h, d * h - a * e - b * f - c * g]


def a_from_b(body_from_a, body_from_b):
    """Pose x y z qx qy qz qw of b in a, from those of both in the body."""
    back = [-body_from_a[3], -body_from_a[4], -body_from_a[5], body_from_a[6]]
    shift = [b - a for a, b in zip(body_from_a[:3], body_from_b[:3])]
    return [*turned(rows_of(back), shift), *times(back, body_from_b[3:])]


class Sensors:
    """LiDAR and IMU of a recording, and where one is in the other's frame."""

    def __init__(self, rig):
        if not rig["imus"]:
            sys.exit("the recording has no IMU, which this program needs")
        self.lidar, self.imu = rig["lidars"][0], rig["imus"][0]
        self.imu_from_lidar = a_from_b(self.imu["body_from_imu"], self.lidar["body_from_lidar"])
        self.lidar_from_imu = a_from_b(self.lidar["body_from_lidar"], self.imu["body_from_imu"])
        self.points, self.imu_topic = f"/{self.lidar['id']}/points", f"/{self.imu['id']}/imu"

    def maker_is(self, maker):
        return self.lidar["model"].startswith(maker)

    def densities(self, noise, shipped):
        """Densities of accelerometer, gyroscope, and of their biases' walks."""
        if noise == "program":
            return shipped
        keys = "accel_noise_density", "gyro_noise_density", "accel_bias_walk", "gyro_bias_walk"
        return [self.imu[key] for key in keys]


def fast_lio2(s, noise):
    """Its filter takes variances of the noise: of acc_cov and gyr_cov it ships 0.1."""
    kind = {"livox": 1, "velodyne": 2, "ouster": 3}
    found = [number for maker, number in kind.items() if s.maker_is(maker)]
    if not found:
        sys.exit(f"FAST-LIO2 reads clouds of Livox, Velodyne and Ouster, not of {s.lidar['model']}")
    roots = s.densities(noise, [math.sqrt(0.1), math.sqrt(0.1), 0.01, 0.01])
    acc, gyr, b_acc, b_gyr = (max(root * root, 1e-12) for root in roots)
    topic = f"/{s.lidar['id']}/livox" if s.maker_is("livox") else s.points
    return {
        "common": {"lid_topic": topic, "imu_topic": s.imu_topic, "time_sync_en": False,
                   "time_offset_lidar_to_imu": 0.0},
        # Times of points: of a Velodyne in s (0), of an Ouster in ns (3).
        "preprocess": {"lidar_type": found[0], "scan_line": max(s.lidar["rows"], 1),
                       "timestamp_unit": 0 if found[0] == 2 else 3,
                       "scan_rate": round(s.lidar["rate_hz"]), "blind": s.lidar["min_range_m"]},
        "mapping": {"acc_cov": acc, "gyr_cov": gyr, "b_acc_cov": b_acc, "b_gyr_cov": b_gyr,
                    "fov_degree": 360.0, "det_range": s.lidar["max_range_m"],
                    "extrinsic_est_en": False, "extrinsic_T": s.imu_from_lidar[:3],
                    "extrinsic_R": rows_of(s.imu_from_lidar[3:])},
        "publish": {"path_en": False, "scan_publish_en": True, "dense_publish_en": True,
                    "scan_bodyframe_pub_en": False},
        "pcd_save": {"pcd_save_en": False, "interval": -1},
        "feature_extract_enable": False, "point_filter_num": 3, "max_iteration": 3,
        "filter_size_surf": 0.5, "filter_size_map": 0.5, "cube_side_length": 1000.0,
    }


def fast_lio2_ros2(s, noise):
    return {"/**": {"ros__parameters": fast_lio2(s, noise)}}


def lio_sam(s, noise):
    """All its parameters, since it has few useful defaults; the values are those that it ships."""
    acc, gyr, b_acc, b_gyr = s.densities(
        noise, [3.9939570888238808e-03, 1.5636343949698187e-03, 6.4356659353532566e-05,
                3.5640318696367613e-05])
    kind = next((m for m in ("livox", "ouster") if s.maker_is(m)), "velodyne")
    turn = rows_of(s.lidar_from_imu[3:])
    return {"lio_sam": {
        "pointCloudTopic": s.points, "imuTopic": s.imu_topic, "odomTopic": "odometry/imu",
        "gpsTopic": "odometry/gpsz", "lidarFrame": "base_link", "baselinkFrame": "base_link",
        "odometryFrame": "odom", "mapFrame": "map", "useImuHeadingInitialization": False,
        "useGpsElevation": False, "gpsCovThreshold": 2.0, "poseCovThreshold": 25.0,
        "savePCD": False, "savePCDDirectory": "/tmp/", "sensor": kind,
        "N_SCAN": max(s.lidar["rows"], 1), "Horizon_SCAN": s.lidar["columns"] or 1800,
        "downsampleRate": 1, "lidarMinRange": s.lidar["min_range_m"],
        "lidarMaxRange": s.lidar["max_range_m"], "imuAccNoise": acc, "imuGyrNoise": gyr,
        "imuAccBiasN": b_acc, "imuGyrBiasN": b_gyr, "imuGravity": 9.80511, "imuRPYWeight": 0.01,
        "extrinsicTrans": s.lidar_from_imu[:3], "extrinsicRot": turn,
        "extrinsicRPY": turn, "edgeThreshold": 1.0, "surfThreshold": 0.1,
        "edgeFeatureMinValidNum": 10, "surfFeatureMinValidNum": 100, "odometrySurfLeafSize": 0.4,
        "mappingCornerLeafSize": 0.2, "mappingSurfLeafSize": 0.4, "z_tollerance": 1000.0,
        "rotation_tollerance": 1000.0, "numberOfCores": 4, "mappingProcessInterval": 0.15,
        "surroundingkeyframeAddingDistThreshold": 1.0,
        "surroundingkeyframeAddingAngleThreshold": 0.2, "surroundingKeyframeDensity": 2.0,
        "surroundingKeyframeSearchRadius": 50.0, "loopClosureEnableFlag": True,
        "loopClosureFrequency": 1.0, "surroundingKeyframeSize": 50,
        "historyKeyframeSearchRadius": 15.0, "historyKeyframeSearchTimeDiff": 30.0,
        "historyKeyframeSearchNum": 25, "historyKeyframeFitnessScore": 0.3,
        "globalMapVisualizationSearchRadius": 1000.0, "globalMapVisualizationPoseDensity": 10.0,
        "globalMapVisualizationLeafSize": 1.0}}


def dlio(s, noise):
    """It has no densities; its observer's gains stay as they are."""
    if noise != "program":
        sys.exit("DLIO has no densities of noise")
    imu, lidar = s.imu["body_from_imu"], s.lidar["body_from_lidar"]
    return {"/**": {"ros__parameters": {
        "extrinsics/baselink2imu/t": imu[:3], "extrinsics/baselink2imu/R": rows_of(imu[3:]),
        "extrinsics/baselink2lidar/t": lidar[:3], "extrinsics/baselink2lidar/R": rows_of(lidar[3:])}}}


def glim(s, noise):
    """Files of its folder of configuration that depend on the sensor, by name."""
    acc, gyr, b_acc, b_gyr = s.densities(noise, [0.05, 0.02, 1e-5, 1e-5])
    modules = ("odometry", "sub_mapping", "global_mapping")
    return {
        "config.json": {"global": {
            "config_path": "", **{f"config_{name}": f"config_{name}.json"
                                  for name in ("ros", "logging", "viewer", "sensors", "preprocess")},
            **{f"config_{name}": f"config_{name}_cpu.json" for name in modules}}},
        "config_ros.json": {"glim_ros": {
            "enable_local_mapping": True, "enable_global_mapping": True, "keep_raw_points": False,
            "imu_time_offset": 0.0, "points_time_offset": 0.0, "acc_scale": 1.0,
            "imu_topic": s.imu_topic, "points_topic": s.points, "image_topic": "",
            "extension_modules": []}},
        "config_sensors.json": {"sensors": {
            "imu_acc_noise": acc, "imu_gyro_noise": gyr, "imu_int_noise": 0.001,
            "imu_bias_noise": max(b_acc, b_gyr), "global_shutter_lidar": False,
            "T_lidar_imu": s.lidar_from_imu, "intensity_field": "intensity", "ring_field": "",
            "autoconf_perpoint_times": False, "autoconf_prefer_frame_time": True,
            "perpoint_relative_time": True, "perpoint_time_scale": 1e-9}}}


PROGRAMS = {make.__name__: make for make in (fast_lio2, fast_lio2_ros2, lio_sam, dlio, glim)}


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", choices=PROGRAMS)
    parser.add_argument("rig", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--noise", choices=("program", "sensor"), default="program")
    given = parser.parse_args()
    sensors = Sensors(json.loads(given.rig.read_text(encoding="utf-8")))
    settings = PROGRAMS[given.program](sensors, given.noise)
    files = settings if given.program == "glim" else {"": settings}
    for name, content in files.items():
        path = given.out / name if name else given.out
        path.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
