#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Flies the Mid-360 through the House in gz-sim and compares the recording with what
`lidarena simulate` makes of the same flight; then a SLAM method runs on it and is scored, and the
topics of ROS 2 are compared with a recording.

usage: house.py RUN_WORLD PLUGIN_PATH LIDARENA COMPARE_DATASETS [SECONDS]
Prints each result and exits with 1 if a check fails.
"""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
METHOD = "fast_lio2"
MAX_ATE_M = 0.10  # what the method reaches on such flights is a fourth of it
failures = []


def check(holds, text):
    print(("ok      " if holds else "FAILED  ") + text, flush=True)
    if not holds:
        failures.append(text)


def command(*arguments, **options):
    done = subprocess.run([str(a) for a in arguments], stdout=subprocess.PIPE, text=True,
                          stderr=subprocess.STDOUT, timeout=500, **options)
    return done.returncode, re.sub(r"\x1b\[[0-9;]*m", "", done.stdout)  # without colors


def make_world(folder, lidarena, seconds):
    """Exports the House and its flight and writes a world that records them; returns the recording."""
    status, output = command(HERE.parent / "prepare", folder, "house",
                             env=dict(os.environ, LIDARENA=str(lidarena)))
    if status != 0:
        raise RuntimeError(output)
    world = folder / "house.sdf"
    recorded = folder / "recorded"
    text = world.read_text()
    text = text.replace("<record>recorded_house</record>", f"<record>{recorded}</record>")
    text = text.replace("<record_seconds>60<", f"<record_seconds>{seconds}<")
    text = text.replace("<real_time_factor>1<", "<real_time_factor>0<")
    text = text.replace("<trajectory>house.tum<", f"<trajectory>{folder}/house.tum<")
    world.write_text(text)
    return world, recorded


def fly(run_world, plugins, folder, world, **environment):
    """Runs the world until the plugin stops it; prints what the sensor cost."""
    env = dict(os.environ, **environment, IGN_GAZEBO_SYSTEM_PLUGIN_PATH=plugins, GZ_SIM_SYSTEM_PLUGIN_PATH=plugins,
               IGN_GAZEBO_RESOURCE_PATH=f"{folder}/models", GZ_SIM_RESOURCE_PATH=f"{folder}/models",
               IGN_IP="127.0.0.1", GZ_IP="127.0.0.1", IGN_PARTITION=f"lidarena_{os.getpid()}",
               GZ_PARTITION=f"lidarena_{os.getpid()}")
    status, output = command(run_world, world, 3600, env=env)
    cost = [line.split("lidarena: ")[-1] for line in output.splitlines() if "CPU:" in line]
    check(status == 0 and cost, "the world ran until the recording ended")
    print("        " + cost[0] if cost else output[-4000:])


def compare(lidarena, compare_datasets, folder, recorded, seconds, noise):
    """The recording against the same flight without a simulator around it."""
    simulated = folder / f"simulated_{noise}"
    status, output = command(lidarena, "simulate", "--world", "house", "--flight", "house", "--sensor",
                             "livox_mid360", "--seed", 1, "--noise", noise, "--seconds", seconds,
                             "--quiet", "--out", simulated)
    if status != 0:
        raise RuntimeError(output)
    status, output = command(compare_datasets, simulated, recorded)
    print("        " + output.strip().replace("\n", "\n        "))
    check(status == 0, "all but one in 1000 points are those of lidarena simulate within 1e-4 m, "
                       f"noise {noise}")
    samples = re.search(r"(\d+) IMU samples: angular rates within (\S+) rad/s, accelerations within "
                        r"(\S+) m/s", output)
    check(bool(samples) and int(samples[1]) > 180 * seconds and float(samples[2]) < 1e-3 and
          float(samples[3]) < 1e-2, "the IMU's samples are those of lidarena simulate")


def publish(run_world, plugins, lidarena, compare_datasets, folder, world):
    """Flies in real time without noise, with the topics of ROS 2 on; a subscriber must get what was
    recorded, and that must be what `lidarena simulate` makes without noise."""
    if command(lidarena, "record", "--help")[0] != 0:
        print("skipped: lidarena was built without DDS")
        return
    text = re.sub("<record>.*</record>",
                  f"<record>{folder}/sent</record><ros>on</ros><noise>off</noise>", world.read_text())
    text = re.sub("<record_seconds>.*</record_seconds>", "<record_seconds>3</record_seconds>", text)
    paced = folder / "paced.sdf"
    paced.write_text(text.replace("<real_time_factor>0<", "<real_time_factor>1<"))
    domain = str(100 + os.getpid() % 100)
    topics = ["--topic", "/livox_mid360/points", "/livox_mid360/imu"]
    subscriber = subprocess.Popen([lidarena, "record", *topics, "--idle", "3", "--quiet", "--out",
                                   folder / "received.mcap", "--domain", domain],
                                  stdout=subprocess.DEVNULL)
    try:
        fly(run_world, plugins, folder, paced, ROS_DOMAIN_ID=domain)
        subscriber.wait(timeout=60)
    finally:
        subscriber.kill()
    status, output = command(compare_datasets, folder / "sent", folder / "received.mcap")
    print("        " + output.strip().replace("\n", "\n        "))
    scans = re.search(r"(\d+) scans.* 0 farther apart; 0 shots", output)
    check(status == 0 and bool(scans) and int(scans[1]) >= 27,
          "a subscriber of the ROS 2 topics got the scans that were recorded")
    compare(lidarena, compare_datasets, folder, folder / "sent", 3, "off")


def run_method(lidarena, folder, recorded):
    shutil.copy(folder / "house.ply", recorded / "world.ply")
    run = folder / "run"
    status, output = command(lidarena, "run", METHOD, recorded, "--out", run, "--quiet")
    check(status == 0, f"{METHOD} runs on the recording")
    status, output = command(lidarena, "evaluate", run, "--quiet")
    metrics = json.loads((run / "metrics.json").read_text()) if status == 0 else {}
    if status != 0:
        print(output)
    if not metrics:
        return check(False, f"{METHOD} is scored")
    final = metrics["final"]
    ate = final["ate"]["se3"]["translation"]["rmse_m"]
    rpe = final["rpe"]["1m_at_poses"]["translation"]["rmse_m"]
    check(final["status"] == "ok" and ate < MAX_ATE_M,
          f"{METHOD} is scored: ATE {100 * ate:.2f} cm, RPE per meter {100 * rpe:.2f} cm")


def main():
    run_world, plugins, lidarena, compare_datasets = sys.argv[1:5]
    seconds = int(sys.argv[5]) if len(sys.argv) > 5 else 20
    folder = pathlib.Path(tempfile.mkdtemp(prefix="lidarena_gz_sim_"))
    try:
        world, recorded = make_world(folder, pathlib.Path(lidarena).resolve(), seconds)
        fly(run_world, plugins, folder, world)
        if not failures:
            compare(lidarena, compare_datasets, folder, recorded, seconds, "on")
            run_method(lidarena, folder, recorded)
            publish(run_world, plugins, lidarena, compare_datasets, folder, world)
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    print(f"{len(failures)} failures" if failures else "all checks passed")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
