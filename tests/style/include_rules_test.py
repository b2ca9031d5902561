#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What the include rules must refuse is refused."""
import pathlib
import tempfile

import include_rules

CASES = [  # file, what it includes, whether that is allowed
    ("odometry/kiss_icp/kiss_icp.cpp", "lidarena/dataset/open_dataset.hpp", False),
    ("odometry/run.cpp", "lidarena/dataset/run_files.hpp", False),
    ("odometry/run.cpp", "lidarena/base/event.hpp", True),
    ("odometry/kiss_icp/kiss_icp.cpp", "lidarena/world/world.hpp", False),
    ("odometry/kiss_icp/kiss_icp.cpp", "lidarena/odometry/ct_icp/ct_icp.hpp", False),
    ("sensor/lidar.cpp", "lidarena/dataset/dataset.hpp", False),
    ("sensor/lidar.cpp", "lidarena/base/point_truth.hpp", True),
    ("stages/score_run.cpp", "lidarena/study/study.hpp", False),
    ("study/runner.cpp", "lidarena/stages/score_run.hpp", True),
    ("base/log.cpp", "iostream", False),
]

for file, header, allowed in CASES:
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "lidarena" / file
        path.parent.mkdir(parents=True)
        path.write_text(f'#include "{header}"\n')
        found = list(include_rules.violations(pathlib.Path(folder)))
        assert (not found) == allowed, f"{file} includes {header}: {found}"
print(f"{len(CASES)} cases")
