# SPDX-License-Identifier: BSD-3-Clause
"""usage: rewrite.py IN.bag OUT.bag none|lz4|bz2   rewrites all messages with ROS 1's own writer."""
import sys

import rosbag

with rosbag.Bag(sys.argv[1]) as source, rosbag.Bag(
        sys.argv[2], "w", compression=sys.argv[3], chunk_threshold=300_000) as out:
    for topic, message, time in source.read_messages():
        out.write(topic, message, time)
