# SPDX-License-Identifier: BSD-3-Clause
"""Lidarena: LiDAR simulation, SLAM and scoring in mesh worlds.

    import lidarena

    world = lidarena.load_world("house")
    flight = lidarena.make_flight("house", world)
    sensor = lidarena.load_sensor("livox_mid360")
    events = lidarena.simulate(world, flight, [sensor], seconds=5)
    odometry = lidarena.make_odometry(lidarena.make_rig([sensor]), "kiss_icp")
    result = lidarena.run(odometry, events)
    print(lidarena.evaluate(result.trajectory, flight.sample(result.trajectory.stamps)))

Times are integer nanoseconds, lengths meters, angles radians, poses 4x4 matrices named
a_from_b. Arrays are views, not copies, where the documentation says "a view"; they are read-only
and keep their owner alive. Long calls release the GIL. Bad input raises InputError (a ValueError),
which names place and remedy; messages go to logging.getLogger("lidarena").
"""
import csv as _csv
import importlib.machinery as _machinery
import os as _os
import pathlib as _pathlib
import re as _re
import sys as _sys


def _check_python():
    """Fails if the module beside this file is for another Python, as in a wheel for any Python."""
    names = [file.name for file in _pathlib.Path(__file__).parent.glob("_core.cpython-*.so")]
    if names and not any(name == "_core" + suffix for name in names for suffix in _machinery.EXTENSION_SUFFIXES):
        made_for = ".".join(_re.match(r"_core\.cpython-(\d)(\d+)", names[0]).groups())
        raise ImportError(f"lidarena: the module is for Python {made_for} and this is Python "
                          f"{_sys.version_info[0]}.{_sys.version_info[1]}; use Python {made_for}, "
                          "or the command lidarena, which needs no module")


_check_python()

import numpy as _numpy  # noqa: E402

from . import _core  # noqa: E402
from ._core import (  # noqa: E402, F401
    POINT, ConfigFolder, Dataset, DatasetWriter, Error, EventSource, Flight, ImuInfo, ImuSample,
    InputError, Lidar, LidarInfo, MemoryUse, Motion, Odometry, OdometryTraits, Rig, RunResult, Scan,
    ScanResult, Sensor, Trajectory, World, __version__, evaluate, list_algorithms, load_truth,
    make_odometry, make_rig, map_error, open_dataset, read_cloud, read_trajectory, replay, run,
    run_algorithm, score_run, simulate, write_cloud)


def _find_configs():
    """$LIDARENA_CONFIGS, configs/ in this package, or share/lidarena/configs in a parent folder."""
    here = _pathlib.Path(__file__).parent
    candidates = [here / "configs", *(up / "share/lidarena/configs" for up in here.parents)]
    if "LIDARENA_CONFIGS" in _os.environ:
        candidates.insert(0, _pathlib.Path(_os.environ["LIDARENA_CONFIGS"]))
    for folder in candidates:
        if (folder / "worlds").is_dir():
            return ConfigFolder(folder)
    raise InputError("lidarena: no folder configs/ found for the package; set LIDARENA_CONFIGS")


#: Named worlds, flights, sensors, odometry, studies; assign another ConfigFolder to change it.
configs = _find_configs()


def matrix(pose):
    """The 4x4 matrix of a pose as files write it: x y z qx qy qz qw."""
    x, y, z, qx, qy, qz, qw = pose
    skew = _numpy.array([[0, -qz, qy], [qz, 0, -qx], [-qy, qx, 0]])
    out = _numpy.eye(4)
    out[:3, :3] += (2 * qw * skew + 2 * skew @ skew) / (qx * qx + qy * qy + qz * qz + qw * qw)
    out[:3, 3] = x, y, z
    return out


def load_world(name_or_file, seed=None, allow_missing=False):
    """Loads a world of configs/worlds by its name, or any mesh, SDF or YAML file.

    With allow_missing, an SDF world is loaded without the models and meshes that cannot be found.
    """
    file = configs.resolve("worlds", str(name_or_file))
    return _core.load_world_file(file, seed, allow_missing)


def make_flight(name_or_file, world):
    """Makes a flight of configs/flights by its name, from a YAML file, or from a TUM trajectory."""
    return _core.make_flight_file(configs.resolve("flights", str(name_or_file)), world)


def _sensors():
    """The folder of the sensors that a file may name as its base."""
    return _pathlib.Path(configs.root) / "sensors"


def load_sensor(name_or_file):
    """Loads a sensor of configs/sensors by its name, or a YAML file."""
    return _core.load_sensor_file(configs.resolve("sensors", str(name_or_file)), _sensors())


def simulate_dataset(world, flight, sensors, out, **options):
    """Simulates a flight into a dataset folder, as `lidarena simulate` does; takes names or files.

    Options: seed, seconds, noise, mode, truth, data, format, dialect, threads.
    """
    return _core.simulate_dataset_files(
        configs.resolve("worlds", str(world)), configs.resolve("flights", str(flight)),
        [configs.resolve("sensors", str(s)) for s in sensors], out, shipped_sensors=_sensors(),
        **options)


def _value(text):
    """A number, a text, or None for an empty one."""
    try:
        return float(text) if text else None
    except ValueError:
        return text


def study_rows(folder):
    """The runs of a study, a dict each: settings, status and figures, None where there is none.

    The unit is the end of a figure's name. pandas.DataFrame(study_rows(folder)) is a table of them.
    """
    file = _pathlib.Path(folder) / "results.csv"
    if not file.exists():
        raise InputError(f"{file}: does not exist; give the folder of a study that has its report")
    with open(file, newline="", encoding="utf-8") as lines:
        return [{name: text if name in ("run", "key") else _value(text)
                 for name, text in row.items()} for row in _csv.DictReader(lines)]
