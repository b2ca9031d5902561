#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Dummies of SLAM programs of others: each takes the arguments that the real program takes.

A dummy is called by a link with the name of the program. Its poses are the true ones, of TRUTH
(file of `time x y z qx qy qz qw` of the body), in the frame, at the instants, and with the stamps that
the real program has. So a score near 0 shows that configs/programs/NAME.yaml has them right. START is
the stamp, s, that the recording should begin with, LIDAR and IMU are their positions in the body.
"""
import argparse
import json
import os
import pathlib
import re
import signal
import struct
import sys
import time

PERIOD, LAST = 0.1, 0.099995  # s, of a Mid-360: from scan to scan, from a scan's first point to its last
START = float(os.environ.get("START", 0))


def truth():
    with open(os.environ["TRUTH"], encoding="utf-8") as lines:
        rows = [[float(v) for v in line.split()] for line in lines if not line.startswith("#")]
    return {round(row[0] * 1000): row[1:] for row in rows}


def poses(frame, offset):
    """(stamp of the scan on the program's clock, pose of the frame `offset` s after it)."""
    by_ms = truth()
    position = [float(v) for v in os.environ[frame].split(",")] if frame else [0, 0, 0]
    scans = int(max(by_ms) / 1000 / PERIOD + 0.5)
    for scan in range(scans):
        instant = scan * PERIOD + offset
        ms = instant * 1000
        before, after = by_ms[int(ms)], by_ms[min(int(ms) + 1, max(by_ms))]
        share = ms - int(ms)
        x, y, z, *q = [a + share * (b - a) for a, b in zip(before, after)]
        m = matrix(q)
        lever = [sum(m[i][j] * position[j] for j in range(3)) for i in range(3)]
        yield START + scan * PERIOD, [x + lever[0], y + lever[1], z + lever[2]], q


def matrix(q):
    x, y, z, w = q
    return [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]


def first_stamp(mcap, topic):
    """Time, s, of the first message of a topic in an MCAP file without compression."""
    data = pathlib.Path(mcap).read_bytes()
    at, channel = 8, None

    def records(block):
        here = 0
        while here < len(block):
            kind, size = struct.unpack_from("<BQ", block, here)
            yield kind, block[here + 9:here + 9 + size]
            here += 9 + size

    while at < len(data) - 8:
        kind, size = struct.unpack_from("<BQ", data, at)
        block, at = data[at + 9:at + 9 + size], at + 9 + size
        if kind == 6:  # a chunk: start, end, size, checksum, name of compression, records
            compression, = struct.unpack_from("<I", block, 28)
            block = block[32 + compression + 8:]
        else:
            block = struct.pack("<BQ", kind, size) + block
        for inner, content in records(block):
            if inner == 4 and topic.encode() in content:
                channel, = struct.unpack_from("<H", content)
            if inner == 5 and struct.unpack_from("<H", content)[0] == channel:
                return struct.unpack_from("<HIQ", content)[2] * 1e-9
    sys.exit(f"{mcap} has no message of {topic}")


def check_start(mcap, topic):
    stamp = first_stamp(mcap, topic)
    if abs(stamp - START) > 0.2:
        sys.exit(f"the first stamp of {topic} is {stamp}, not {START}")


def kiss_icp_pipeline(offset=LAST, settings="kiss_icp_out_dir"):
    parser = argparse.ArgumentParser()
    parser.add_argument("--topic", "-t")
    parser.add_argument("--config")
    parser.add_argument("data", type=pathlib.Path)
    given = parser.parse_args()
    check_start(given.data, given.topic)
    out = pathlib.Path(os.environ[settings], "2026-01-01_00-00-00")
    out.mkdir(parents=True)
    out.parent.joinpath("latest").symlink_to(out)
    kitti, tum = [], []
    for stamp, p, q in poses("LIDAR", offset):
        m = matrix(q)
        kitti.append(" ".join(f"{v:.18e}" for i in range(3) for v in [*m[i], p[i]]))
        tum.append(" ".join(f"{v:.4f}" for v in [stamp, *p, *q]))
    out.joinpath("data_poses_kitti.txt").write_text("\n".join(kitti) + "\n")
    out.joinpath("data_poses_tum.txt").write_text("\n".join(tum) + "\n")


def genz_icp_pipeline():
    kiss_icp_pipeline(LAST / 2, "genz_icp_out_dir")


def rko_lio():
    parser = argparse.ArgumentParser()
    for name in ("--lidar", "--imu", "--run_name"):
        parser.add_argument(name, required=True)
    parser.add_argument("--log_dir", type=pathlib.Path, required=True)
    parser.add_argument("-c")
    parser.add_argument("data", type=pathlib.Path)
    given = parser.parse_args()
    assert (given.data / "metadata.yaml").exists(), "not a folder of rosbag2"
    check_start(given.data / "data.mcap", given.lidar)
    out = given.log_dir / f"{given.run_name}_0"
    out.mkdir(parents=True)
    rows = [f"{stamp + LAST:.6f} " + " ".join(f"{v:.6f}" for v in [*p, *q]) for stamp, p, q in poses("LIDAR", LAST)]
    out.joinpath(f"{given.run_name}_0_tum.txt").write_text("\n".join(rows) + "\n")


def evalio():
    assert sys.argv[1] == "run", sys.argv
    parser = argparse.ArgumentParser()
    parser.add_argument("-d", required=True)
    parser.add_argument("-p", required=True)
    parser.add_argument("-o", type=pathlib.Path, required=True)
    given = parser.parse_args(sys.argv[2:])
    assert os.environ["EVALIO_CUSTOM"] == "lidarena_evalio"
    rig = json.loads(pathlib.Path(os.environ["LIDARENA_RIG"]).read_text(encoding="utf-8"))
    check_start(pathlib.Path(os.environ["LIDARENA_RECORDING"], "data.mcap"), f"/{rig['lidars'][0]['id']}/points")
    offset = {"ct": 0, "liosam": 0, "genz": LAST / 2, "dlio": LAST / 2}[given.p]
    rows = ["# name: x", "# timestamp, x, y, z, qx, qy, qz, qw"]
    rows += [",".join(f"{v:.9f}" for v in [stamp, *p, *q]) for stamp, p, q in poses("IMU", offset)]
    folder = given.o / given.d
    folder.mkdir(parents=True)
    folder.joinpath(f"{given.p}.csv").write_text("\n".join(rows) + "\n")


def run_odometry():
    """CT-ICP's command line: frames of KITTI-CARLA in, the first pose and the scans' last ones out, as PLY."""
    assert sys.argv[1] == "-c", sys.argv
    settings = dict(re.findall(r"^ *(?:- )?(\w+): *([^#\n]*?) *(?:#.*)?$", pathlib.Path(sys.argv[2]).read_text(), re.MULTILINE))
    assert (settings["sequence_name"], settings["save_mid_frame"], settings["voxel_size"]) == ("Town01", "0", "0.3")
    frames = pathlib.Path(settings["root_path"], "Town01/frames")
    scans = list(poses("LIDAR", LAST))
    assert int(settings["max_num_frames"]) == len(scans), settings
    for scan, (stamp, _, _) in enumerate(scans):
        header, _, points = (frames / f"frame_{scan:04}.ply").read_bytes().partition(b"end_header\n")
        times = [t for x, y, z, t in struct.iter_unpack("<fffd", points)]
        assert f"element vertex {len(times)}\n".encode() in header and len(times) > 1000, header
        assert abs(min(times) - stamp) < 1e-3 and abs(max(times) - stamp - LAST) < 1e-3, (min(times), max(times), stamp)
    first, = [(START, p, q) for stamp, p, q in poses("LIDAR", 0) if stamp == START]
    rows = [first] + [(stamp + LAST, p, q) for stamp, p, q in scans]
    names = "qx qy qz qw x y z ref_t dest_t".split()
    header = "".join(f"property double {name}\n" for name in names) + "property int ref_fid\nproperty int dest_fid\n"
    out = pathlib.Path(settings["output_dir"])
    out.mkdir()
    (out / "KITTI_CARLA_Town01.PLY").write_bytes(
        f"ply\nformat binary_little_endian 1.0\nelement pose {len(rows)}\n{header}end_header\n".encode()
        + b"".join(struct.pack("<9d2i", *q, *p, 0, t, 0, i) for i, (t, p, q) in enumerate(rows)))


def note(what):
    with open(os.environ["NOTES"], "a", encoding="utf-8") as notes:
        notes.write(what + "\n")


def roscore():
    assert sys.argv[1] == "-p" and sys.argv[2] in os.environ["ROS_MASTER_URI"], sys.argv
    signal.pause()


def rosparam():
    if sys.argv[1] == "load":
        json.loads(pathlib.Path(sys.argv[2]).read_text(encoding="utf-8"))
    note("rosparam " + " ".join(sys.argv[1:2]))


def rosrun():
    note("rosrun " + " ".join(sys.argv[1:]))
    signal.pause()


def roslaunch():
    note("roslaunch " + " ".join(sys.argv[1:]))
    signal.pause()


def rospack():
    sys.exit(0 if sys.argv[1:] in (["find", "fast_lio"], ["find", "lio_sam"]) else 1)


def rosbag():
    """`rosbag play` reads the bag's first stamp; `rosbag record` writes the poses at the end."""
    import nav_msgs.msg
    import rosbag as bags
    import rospy
    if sys.argv[1] == "play":
        assert sys.argv[2] == "--clock", sys.argv
        with bags.Bag(sys.argv[3]) as bag:
            stamps = [m.header.stamp.to_sec() for t, m, _ in bag.read_messages() if t.endswith("/imu")]
        assert abs(stamps[0] - START) < 0.2, stamps[0]
        return
    record, option, path, topic, name = sys.argv[1:]
    assert (record, option, name) == ("record", "-O", "__name:=lidarena_recorder"), sys.argv
    frame, offset, shift = {"/Odometry": ("IMU", LAST, LAST),
                            "/lio_sam/mapping/odometry": ("LIDAR", 0, 0)}[topic]

    def write(*_):
        with bags.Bag(path, "w") as bag:
            for stamp, p, q in poses(frame, offset):
                message = nav_msgs.msg.Odometry()
                message.header.stamp = rospy.Time.from_sec(stamp + shift)
                message.header.frame_id = "odom"
                message.pose.pose.position.x, message.pose.pose.position.y, message.pose.pose.position.z = p
                o = message.pose.pose.orientation
                o.x, o.y, o.z, o.w = q
                bag.write(topic, message, message.header.stamp)
        sys.exit(0)

    signal.signal(signal.SIGINT, write)
    while True:
        time.sleep(0.1)


def ros2():
    """Packages are there; a node notes its arguments and ends; glim_rosbag writes its poses."""
    if sys.argv[1:3] == ["pkg", "prefix"]:
        print(os.environ["SHARE"])
        return
    note("ros2 " + " ".join(sys.argv[1:]))
    if sys.argv[1:4] != ["run", "glim_ros", "glim_rosbag"]:
        sys.exit(3)
    parameters = dict(p.split(":=") for p in sys.argv if ":=" in p)
    config = pathlib.Path(parameters["config_path"])
    topics = json.loads((config / "config_ros.json").read_text(encoding="utf-8"))["glim_ros"]
    check_start(pathlib.Path(sys.argv[4], "data.mcap"), topics["points_topic"])
    out = pathlib.Path(parameters["dump_path"])
    out.mkdir()
    rows = [f"{stamp:.9f} " + " ".join(f"{v:.9f}" for v in [*p, *q]) for stamp, p, q in poses("IMU", 0)]
    out.joinpath("traj_imu.txt").write_text("\n".join(rows) + "\n")


if __name__ == "__main__":
    globals()[pathlib.Path(sys.argv[0]).name]()
