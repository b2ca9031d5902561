# SPDX-License-Identifier: BSD-3-Clause
"""A recording of Lidarena as a dataset of evalio (0.5): `LidarenaRecording.flight`.

evalio finds this module by EVALIO_CUSTOM=lidarena_evalio. LIDARENA_RIG is the file of LiDAR and IMU
({rig} of a command line), LIDARENA_RECORDING the folder of the recording, an MCAP file with stamps at
the start of scans. It has no truth: evalio's own scores of a run mean nothing.
"""
import json
import os
import pathlib
from enum import auto

import numpy as np
from evalio.datasets import Dataset, RosbagIter
from evalio.datasets.loaders import (LidarDensity, LidarFormatParams, LidarMajor, LidarPointStamp,
                                     LidarStamp)
from evalio.types import SE3, SO3, ImuParams, LidarParams, Stamp, Trajectory

from parameters import a_from_b  # in this folder


class LidarenaRecording(Dataset):
    """The recording that the environment names."""

    flight = auto()

    @staticmethod
    def rig():
        rig = json.loads(pathlib.Path(os.environ["LIDARENA_RIG"]).read_text(encoding="utf-8"))
        if not rig["imus"]:
            raise ValueError("the recording has no IMU, which evalio needs")
        return rig["lidars"][0], rig["imus"][0]

    def files(self):
        return [pathlib.Path(os.environ["LIDARENA_RECORDING"])]

    def data_iter(self):
        lidar, imu = self.rig()
        order = LidarFormatParams(stamp=LidarStamp.Start, point_stamp=LidarPointStamp.Start,
                                  major=LidarMajor.Column, density=LidarDensity.OnlyValidPoints)
        return RosbagIter(self.files()[0], f"/{lidar['id']}/points", f"/{imu['id']}/imu",
                          self.lidar_params(), lidar_format=order)

    def ground_truth_raw(self):
        return Trajectory(stamps=[Stamp.from_sec(0.0)], poses=[SE3.identity()])

    def imu_T_lidar(self):
        lidar, imu = self.rig()
        x, y, z, qx, qy, qz, qw = a_from_b(imu["body_from_imu"], lidar["body_from_lidar"])
        return SE3(SO3(qx=qx, qy=qy, qz=qz, qw=qw), np.array([x, y, z]))

    def imu_T_gt(self):
        return SE3.identity()

    def imu_params(self):
        _, imu = self.rig()
        return ImuParams(gyro=imu["gyro_noise_density"], accel=imu["accel_noise_density"],
                         gyro_bias=imu["gyro_bias_walk"], accel_bias=imu["accel_bias_walk"],
                         bias_init=1e-8, integration=1e-8, gravity=np.array([0, 0, -9.81]),
                         rate=imu["rate_hz"], brand="-", model=imu["model"])

    def lidar_params(self):
        lidar, _ = self.rig()
        return LidarParams(num_rows=max(lidar["rows"], 1), num_columns=max(lidar["columns"], 1),
                           min_range=lidar["min_range_m"], max_range=lidar["max_range_m"],
                           rate=lidar["rate_hz"], brand="-", model=lidar["model"])
