# SPDX-License-Identifier: BSD-3-Clause
"""usage: read_driver.py DATA.bag   (made by write_recording_sample in the dialect "driver")

Reads Livox's CustomMsg and PointCloud2 and the IMU in g with ROS 1's own reader.
"""
import math
import sys

import rosbag
import sensor_msgs.point_cloud2

SCANS, POINTS, START_NS = 20, 5000, 100_000_000_000

bag = rosbag.Bag(sys.argv[1])
types = bag.get_type_and_topic_info().msg_types
assert types["livox_ros_driver2/CustomMsg"] == "e4d6829bdfe657cb6c21a746c86b21a6"
counts = {}
for topic, message, _ in bag.read_messages():
    scan = counts.get(topic, 0)
    counts[topic] = scan + 1
    stamp = START_NS + scan * 100_000_000 + 7
    if topic == "/mid360/livox":
        assert message.header.stamp.to_nsec() == message.timebase == stamp
        assert message.point_num == len(message.points) == POINTS
        for i, point in enumerate(message.points):
            # computed in float32: angles up to 50 rad rounded to 4e-6
            assert abs(point.x - 5 * math.cos(0.01 * (i + scan))) < 5e-5
            assert point.offset_time == 99_999_999 * i // POINTS
            assert (point.reflectivity, point.tag, point.line) == (i % 256, 0, i % 4)
    elif topic == "/mid360/points":
        assert message.point_step == 26
        points = sensor_msgs.point_cloud2.read_points(message)
        for i, (x, y, z, intensity, tag, line, timestamp) in enumerate(points):
            assert (intensity, tag, line) == (i % 256, 0, i % 4)
            assert timestamp == stamp + 99_999_999 * i // POINTS
    elif topic == "/mid360/imu":
        assert abs(message.linear_acceleration.z - 1) < 1e-15
assert counts["/mid360/livox"] == counts["/mid360/points"] == SCANS
print(counts)
