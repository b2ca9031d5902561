#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# usage: run.sh WRITE_RECORDING_SAMPLE FOLDER   writes the sample and checks it with ROS 1's own reader.
# Exits 77 (skipped) where the reader is not installed.
set -eu
here=$(dirname "$0")
python=/usr/bin/python3  # Debian's own, which sees the packages
if ! "$python" -c 'import rosbag, roslz4, sensor_msgs.msg, nav_msgs.msg, tf2_msgs.msg' 2>/dev/null; then
  echo "skipped: ROS 1's reader is not installed; apt-get install python3-rosbag python3-roslz4" \
       "python3-sensor-msgs python3-nav-msgs python3-tf2-msgs"
  exit 77
fi
"$1" "$2" bag
"$python" "$here/read_all.py" "$2/data.bag"
"$1" "$2/driver" bag driver
"$python" "$here/read_driver.py" "$2/driver/data.bag"
# Reads back what ROS 1's own writer makes of the sample; bz2 is written by no other test.
for compression in none lz4 bz2; do
  "$python" "$here/rewrite.py" "$2/data.bag" "$2/$compression.bag" "$compression"
  "$1" check "$2/$compression.bag" 2>"$2/complaint" || {
    grep -q "this build lacks" "$2/complaint" && continue  # built without libbz2
    cat "$2/complaint"
    exit 1
  }
done
