# SPDX-License-Identifier: BSD-3-Clause
"""usage: read_all.py DATA.bag   (made by write_recording_sample: 20 scans of 5000 points)

Reads the bag with ROS 1's own reader (Debian's python3-rosbag), whose messages are built from the
definitions and checksums in the file, and compares them with the values of the sample.
"""
import math
import sys

import rosbag
import sensor_msgs.point_cloud2
from sensor_msgs.msg import Imu, PointCloud2
from nav_msgs.msg import Odometry
from tf2_msgs.msg import TFMessage

SCANS, POINTS, START_NS = 20, 5000, 100_000_000_000


def check_scan(cloud, scan):
    assert cloud.header.stamp.to_nsec() == START_NS + scan * 100_000_000 + 7
    assert cloud.header.frame_id == "mid360_lidar"
    assert (cloud.height, cloud.width, cloud.point_step) == (1, POINTS, 24)
    points = sensor_msgs.point_cloud2.read_points(cloud)
    for i, (x, y, z, intensity, t, ring, echo) in enumerate(points):
        angle = 0.01 * (i + scan)
        # computed in float32: angles up to 50 rad rounded to 4e-6, heights up to 500 m to 3e-5
        assert abs(x - 5 * math.cos(angle)) < 5e-5 and abs(y - 5 * math.sin(angle)) < 5e-5
        assert abs(z - 0.1 * i) < 5e-5 and intensity == i % 256
        assert t == 99_999_999 * i // POINTS and ring == i % 4 and echo == i % 3


def check_imu(imu, i):
    assert imu.header.stamp.to_nsec() == START_NS + i * 5_000_000
    assert abs(imu.angular_velocity.x - math.sin(0.005 * i)) < 1e-15
    assert imu.linear_acceleration.z == 9.80665 and imu.orientation_covariance[0] == -1


def check_odometry(odometry, i):
    assert odometry.header.stamp.to_nsec() == START_NS + i * 5_000_000
    assert (odometry.header.frame_id, odometry.child_frame_id) == ("world", "base_link")
    assert odometry.pose.pose.position.y == 2 * (0.005 * i)


def check_tf(message, i):
    assert message.transforms[0].child_frame_id == "base_link"
    assert message.transforms[0].transform.translation.z == 1.5


def check_static(message, i):
    frames = [transform.child_frame_id for transform in message.transforms]
    assert frames == ["mid360_lidar", "mid360_imu"]


CHECKS = {"/mid360/points": (check_scan, PointCloud2), "/mid360/imu": (check_imu, Imu),
          "/truth/odometry": (check_odometry, Odometry), "/tf": (check_tf, TFMessage),
          "/tf_static": (check_static, TFMessage)}

bag = rosbag.Bag(sys.argv[1])
types, topics = bag.get_type_and_topic_info()
counts = {}
for topic, message, time in bag.read_messages():
    index = counts.get(topic, 0)
    counts[topic] = index + 1
    if topic in CHECKS:
        check, kind = CHECKS[topic]
        # the checksum in ROS's own package of the type
        assert types[kind._type] == kind._md5sum, topic
        assert message._full_text.startswith("std_msgs/Header") or topic.startswith("/tf")
        check(message, index)
assert counts["/mid360/points"] == SCANS and counts["/mid360/imu"] > 20 * SCANS
assert counts["/lidarena/description"] == counts["/tf_static"] == 1
for topic, info in topics.items():
    assert info.message_count == counts[topic], topic
compression = bag.get_compression_info()
assert compression.compression == "lz4" and len(list(bag._get_entries())) == sum(counts.values())
print(counts, compression)
