#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Plays a ROS 1 bag to nodes and writes the poses that they publish.
# usage: ros1.sh BAG OUTPUT TOPIC PARAMETERS COMMAND...
# BAG is played to the nodes that COMMAND starts, after PARAMETERS (YAML) were loaded. The messages of
# TOPIC (nav_msgs/Odometry) become OUTPUT/trajectory.tum. Each call has a ROS master of its own.
set -euo pipefail
bag=$1 output=$2 topic=$3 parameters=$4
shift 4
port=$((20000 + $$ % 20000))
export ROS_MASTER_URI=http://127.0.0.1:$port ROS_IP=127.0.0.1
# The shell has jobs in the background ignore SIGINT, which ends these programs.
env --default-signal=INT roscore -p "$port" >"$output/roscore.log" 2>&1 &
core=$!
nodes=
# The master is no child of roscore's process group: roscore has to end it. A node that waits for the
# bag's clock, which has stopped, may ignore SIGINT: FAST-LIO2 does.
end_all() {
  kill -INT $nodes $core 2>/dev/null || true
  for _ in $(seq 25); do
    kill -0 $nodes 2>/dev/null || break
    sleep 0.2
  done
  kill -TERM $nodes 2>/dev/null || true
  wait $core || true
}
trap end_all EXIT
for _ in $(seq 150); do
  rosparam list >/dev/null 2>&1 && break
  sleep 0.2
done
rosparam set use_sim_time true
rosparam load "$parameters"
env --default-signal=INT "$@" &
nodes=$!
env --default-signal=INT rosbag record -O "$output/odometry.bag" "$topic" __name:=lidarena_recorder &
recorder=$!
nodes="$nodes $recorder"
sleep 3 # until all have found each other
rosbag play --clock "$bag"
sleep 3 # until the last scan is done
kill -INT "$recorder"
wait "$recorder" || true
lidarena convert "$output/odometry.bag" "$output/trajectory.tum"
