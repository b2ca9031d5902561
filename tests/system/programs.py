#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The programs of configs/programs, run as dummies: instants, frames, stamps and parameters.

usage: programs.py PROGRAM CONFIGS
"""
import importlib.util
import json
import os
import pathlib
import subprocess
import sys
import tempfile

PROGRAM, CONFIGS = (pathlib.Path(argument).resolve() for argument in sys.argv[1:3])
DUMMY = pathlib.Path(__file__).resolve().with_name("dummy_programs.py")
SCORED = {"kiss_icp_pip": 0, "genz_icp_pip": 0, "rko_lio": 1000, "evalio_ct_icp": 1000,
          "evalio_genz_icp": 1000, "evalio_dlio": 1000, "evalio_lio_sam": 1000, "glim_ros2": 1000,
          "ct_icp_program": 0}
ROS1 = {"fast_lio2_ros1": 1000, "lio_sam_ros1": 1000}
NODES = {"kiss_icp_ros2": "launch kiss_icp odometry.launch.py topic:=/livox_mid360/points visualize:=false",
         "genz_icp_ros2": "launch genz_icp odometry.launch.py topic:=/livox_mid360/points visualize:=false",
         "dlio_ros2": "-r pointcloud:=/livox_mid360/points -r imu:=/livox_mid360/imu",
         "fast_lio2_ros2": "run fast_lio fastlio_mapping --ros-args --params-file"}


def product(rows, v):
    return [sum(r * x for r, x in zip(row, v)) for row in rows]


def matrix(q):
    x, y, z, w = q
    return [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]


def placed(pose, v):
    return [a + b for a, b in zip(pose[:3], product(matrix(pose[3:]), v))]


def near(a, b):
    return len(a) == len(b) and all(abs(x - y) < 1e-9 for x, y in zip(a, b))


def check_parameters(folder):
    """Mountings in parameter files, of a LiDAR and an IMU that are both turned."""
    lidar, imu = [0.1, -0.2, 0.3, 0.5, 0.5, -0.5, 0.5], [-0.4, 0.1, 0.2, 0.1, -0.7, 0.1, 0.7]
    rig = {"lidars": [{"id": "os", "model": "ouster_os0_128", "kind": "spinning", "rows": 128, "columns": 1024,
                       "rate_hz": 10.0, "min_range_m": 0.3, "max_range_m": 50.0, "body_from_lidar": lidar}],
           "imus": [{"id": "os", "model": "x", "rate_hz": 100.0, "gyro_noise_density": 1e-4,
                     "accel_noise_density": 2e-3, "gyro_bias_walk": 1e-5, "accel_bias_walk": 2e-5,
                     "body_from_imu": imu}]}
    file = folder / "rig.json"
    file.write_text(json.dumps(rig))

    def parameters(program, *more):
        out = folder / f"{program}.json"
        subprocess.run([sys.executable, CONFIGS / "programs/parameters.py", program, file, out, *more], check=True)
        return json.loads(out.read_text())

    point = [1.0, 2.0, 3.0]  # in the body
    in_lidar, in_imu = [placed_back(pose, point) for pose in (lidar, imu)]
    fast = parameters("fast_lio2", "--noise", "sensor")
    rows = [fast["mapping"]["extrinsic_R"][i:i + 3] for i in (0, 3, 6)]
    assert near([a + b for a, b in zip(fast["mapping"]["extrinsic_T"], product(rows, in_lidar))], in_imu), fast
    assert fast["preprocess"]["lidar_type"] == 3 and fast["common"]["lid_topic"] == "/os/points", fast
    assert near([fast["mapping"]["acc_cov"], fast["mapping"]["gyr_cov"]], [4e-6, 1e-8]), fast
    assert parameters("fast_lio2")["mapping"]["acc_cov"] - 0.1 < 1e-12
    lio = parameters("lio_sam")["lio_sam"]
    rows = [lio["extrinsicRot"][i:i + 3] for i in (0, 3, 6)]
    assert near([a + b for a, b in zip(lio["extrinsicTrans"], product(rows, in_imu))], in_lidar), lio
    assert (lio["sensor"], lio["N_SCAN"], lio["Horizon_SCAN"]) == ("ouster", 128, 1024), lio
    dlio = parameters("dlio")["/**"]["ros__parameters"]
    assert dlio["extrinsics/baselink2imu/t"] == imu[:3], dlio
    (folder / "glim").mkdir()
    subprocess.run([sys.executable, CONFIGS / "programs/parameters.py", "glim", file, folder / "glim"], check=True)
    sensors = json.loads((folder / "glim/config_sensors.json").read_text())["sensors"]
    assert near(placed(sensors["T_lidar_imu"], in_imu), in_lidar), sensors


def placed_back(pose, v):
    back = [-pose[3], -pose[4], -pose[5], pose[6]]
    return product(matrix(back), [a - b for a, b in zip(v, pose[:3])])


def main(folder):
    check_parameters(folder)
    (folder / "bin").mkdir()
    for name in ("kiss_icp_pipeline genz_icp_pipeline rko_lio evalio roscore rosparam rosrun roslaunch rospack "
                 "rosbag ros2 run_odometry").split():
        (folder / "bin" / name).symlink_to(DUMMY)
    (folder / "bin/lidarena").symlink_to(PROGRAM)
    (folder / "bin/python3").symlink_to(sys.executable)
    (folder / "share/config").mkdir(parents=True)
    (folder / "share/config/config_odometry_cpu.json").write_text("{}")
    (folder / "ct_icp.yaml").write_text("unit: s\nodometry_options:\n\n  # cells\n  voxel_size: 0.3 # m\n\nmore: 1\n")
    with_dummies = dict(os.environ, PATH=f"{folder}/bin:{os.environ['PATH']}", TRUTH=f"{folder}/data/truth.tum",
                          NOTES=f"{folder}/notes", SHARE=f"{folder}/share", CT_ICP_PROFILE=f"{folder}/ct_icp.yaml")
    without = dict(os.environ, PATH="/usr/bin:/bin")

    def call(*words, env=with_dummies, code=0):
        done = subprocess.run([PROGRAM, *map(str, words), "--configs", CONFIGS], env=env, cwd=folder,
                              capture_output=True, text=True, check=False)
        if done.returncode != code:
            logs = "".join(log.read_text()[-2000:] for log in folder.glob("*/program.log"))
            sys.exit(f"{words}: exit code {done.returncode}\n{done.stdout[-2000:]}{done.stderr[-2000:]}{logs}")
        return done

    ready = {p["name"]: p for p in json.loads(call("list", "programs", "--json").stdout)}
    assert set(ready) == {f.stem for f in (CONFIGS / "programs").glob("*.yaml")}
    assert set(ready) == {*SCORED, *ROS1, *NODES}, "a program without a test"
    assert all(p["installed"] and p["install"] and p["summary"] for p in ready.values()), ready
    bare = {p["name"]: p for p in json.loads(call("list", "programs", "--json", env=without).stdout)}
    assert not bare["kiss_icp_pip"]["installed"], "this machine has KISS-ICP"

    study = ["study", "--world", "house", "--sensors", "livox_mid360", "--algorithms", "kiss_icp", "--auto",
             "--seconds", "1", "--out", "out", "--programs", "kiss_icp_pip,rko_lio"]
    refused = call(*study, env=without, code=2)
    assert "not installed here: kiss_icp_pip, rko_lio" in refused.stderr, refused.stderr
    assert 'pip install "rko-lio[all]"' in refused.stderr, refused.stderr
    assert "did you mean 'rko_lio'" in call(*study[:-1], "rko_li", code=2).stderr
    plan = call(*study[:-1], "installed", "--dry").stdout
    assert all(f"-{name}-external" in plan for name in ready), plan
    assert "-external" not in call(*study[:-1], "installed", "--dry", env=without).stdout

    call("simulate", "--world", "house", "--flight", "house_moving", "--sensor", "livox_mid360", "--seconds", "3",
         "--out", "data")
    rig = json.loads((folder / "data/manifest.json").read_text())["rig"]
    for key, pose in (("LIDAR", rig["lidars"][0]["body_from_lidar"]), ("IMU", rig["imus"][0]["body_from_imu"])):
        assert pose[3:] == [0, 0, 0, 1], "the sensors of a dummy are not turned"
        with_dummies[key] = ",".join(map(str, pose[:3]))
    scored = dict(SCORED)
    if importlib.util.find_spec("rosbag"):
        scored.update(ROS1)
    else:
        print("skipped: the ROS 1 programs, since python3-rosbag is not installed")
    for name, start in scored.items():
        with_dummies["START"] = str(start)
        call("run", name, "data", "--external", name, "--out", name)
        metrics = json.loads(call("evaluate", name, "--json", "--score", "trajectory").stdout)
        rmse = metrics["final"]["ate"]["se3"]["translation"]["rmse_m"]
        print(f"{name}: ATE {1000 * rmse:.3f} mm")
        assert rmse < 2e-4, (name, rmse)

    if "live topics: yes" in call("--version").stdout:
        for name, arguments in NODES.items():
            (folder / "notes").write_text("")
            call("run", name, "data", "--external", name, "--out", name, code=1)
            notes = (folder / "notes").read_text()
            assert arguments in notes, (name, notes)


with tempfile.TemporaryDirectory() as scratch:
    main(pathlib.Path(scratch))
