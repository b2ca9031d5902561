#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Tests the plugins in gzserver. usage: run.py BUILD_FOLDER
Needs Gazebo (see .ci/gazebo); prints each result and exits with 1 if a check fails.
"""
import math
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time

import gzserver

HERE = pathlib.Path(__file__).resolve().parent
failures = []


def check(holds, text):
    print(("ok      " if holds else "FAILED  ") + text, flush=True)
    if not holds:
        failures.append(text)


def bumpy_shell(file, rows=100, columns=200):
    """Writes a closed shell of about 10 m radius with waves: 2 * rows * columns triangles."""
    with open(file, "w") as out:
        for i in range(rows + 1):
            for j in range(columns):
                polar, azimuth = math.pi * i / rows, 2 * math.pi * j / columns
                r = 9 + 0.6 * math.sin(7 * polar) * math.cos(9 * azimuth)
                out.write(f"v {r * math.sin(polar) * math.cos(azimuth):.6f} "
                          f"{r * math.sin(polar) * math.sin(azimuth):.6f} {r * math.cos(polar):.6f}\n")
        for i in range(rows):
            for j in range(columns):
                a, b = i * columns + j + 1, i * columns + (j + 1) % columns + 1
                c, d = a + columns, b + columns
                out.write(f"f {a} {c} {d}\nf {a} {d} {b}\n")


def make_models(folder):
    model = folder / "lidarena_bumps"
    (model / "meshes").mkdir(parents=True)
    bumpy_shell(model / "meshes/bumps.obj")
    (model / "model.config").write_text(
        "<?xml version='1.0'?><model><name>lidarena_bumps</name><version>1.0</version>"
        "<sdf version='1.6'>model.sdf</sdf></model>")
    (model / "model.sdf").write_text(
        "<?xml version='1.0'?><sdf version='1.6'><model name='lidarena_bumps'><static>1</static>"
        "<link name='link'/></model></sdf>")


def compare_with_the_engine(plugins, models):
    for world in ("primitives", "mesh", "falling"):
        status, output = gzserver.run(HERE / "worlds" / f"{world}.world", plugins, [models])
        lines = [line for line in output.splitlines() if line.startswith("COMPARE")]
        print("\n".join(lines))
        check(status == 0 and lines, f"{world}: our ranges equal the engine's within 1e-4 m")
        if status != 0:
            print(output[-2000:])


def record_without_ros(plugins, models, folder):
    """Records a bag without ROS running and reads it with ROS 1's own tools."""
    bag = folder / "recorded.bag"
    world = (HERE / "worlds/record.world").read_text().replace("@RECORD@", str(bag))
    (folder / "record.world").write_text(world)
    status, output = gzserver.run(folder / "record.world", plugins, [models])
    print("\n".join(line for line in output.splitlines() if "lidarena" in line))
    check(bag.exists(), f"a bag was recorded (gzserver exited with {status})")
    if not bag.exists():
        print(output[-3000:])
        return
    try:
        import rosbag
    except ImportError:
        print("skipped: ROS 1's rosbag is not installed")
        return
    counts, frames = {}, []
    with rosbag.Bag(str(bag)) as reader:
        for topic, message, _ in reader.read_messages():
            counts[topic] = counts.get(topic, 0) + 1
            if topic.endswith("/points"):
                frames.append((message.header.stamp.to_sec(), message.width * message.height))
    print(f"        rosbag reads {counts}, scans {frames[:3]}")
    check(counts.get("/livox_mid360/imu", 0) >= 150, "rosbag reads the IMU's samples, 200 per second")
    check(len(frames) >= 7, "rosbag reads the scans, 10 per second")
    check(all(abs(stamp * 10 - round(stamp * 10)) < 1e-6 for stamp, _ in frames),
          "scans are stamped with simulated time, at multiples of 0.1 s")
    check(all(points > 19000 for _, points in frames), "in a closed room nearly all rays return")


def play_with_ros(bag, folder):
    """rosbag play publishes our bag and rosbag record records it: all scans must arrive."""
    tools = pathlib.Path("/usr/lib/rosbag")
    if not (tools / "play").exists() or not shutil.which("rosmaster"):
        print("skipped: ROS 1's rosbag play is not installed")
        return
    import rosbag
    port = gzserver.free_port()
    env = dict(os.environ, ROS_MASTER_URI=f"http://127.0.0.1:{port}", ROS_IP="127.0.0.1",
               ROS_PACKAGE_PATH="/usr/share")
    quiet = {"env": env, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    copy = folder / "played.bag"
    master = subprocess.Popen(["rosmaster", "--core", "-p", str(port)], **quiet)
    time.sleep(3)
    recorder = subprocess.Popen([tools / "record", "-a", "-O", copy], **quiet)
    time.sleep(3)
    try:
        # the recorder needs time to subscribe to the topics that the player advertises
        subprocess.run([tools / "play", "--quiet", "--delay=4", bag], timeout=60, check=True,
                       stdin=subprocess.DEVNULL, **quiet)
        time.sleep(2)
    finally:
        recorder.send_signal(signal.SIGINT)
        recorder.wait(timeout=30)
        master.terminate()
        master.wait(timeout=30)
    with rosbag.Bag(str(bag)) as ours, rosbag.Bag(str(copy)) as theirs:
        topic = "/livox_mid360/points"
        sent, came = ours.get_message_count(topic), theirs.get_message_count(topic)
    check(sent == came, f"rosbag play publishes our bag: {came} of {sent} scans arrive")


def main():
    plugins = sys.argv[1]
    folder = pathlib.Path(tempfile.mkdtemp(prefix="lidarena_gazebo_"))
    models = folder / "models"
    try:
        make_models(models)
        compare_with_the_engine(plugins, models)
        record_without_ros(plugins, models, folder)
        play_with_ros(folder / "recorded.bag", folder)
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    print(f"{len(failures)} failures" if failures else "all checks passed")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
