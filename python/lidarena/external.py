# SPDX-License-Identifier: BSD-3-Clause
"""Lets an odometry written in Python stand in a study, as a program of its own.

    # my_odometry.py
    import lidarena, lidarena.external

    class Mine(lidarena.Odometry):
        def register_scan(self, scan):
            ...
            return lidarena.ScanResult(scan.stamp, world_from_body)

    lidarena.external.main(lambda rig: Mine())

    # study.yaml
    external:
      - {name: mine, command: python3 my_odometry.py {input} {output}, pose_of: body}
    algorithms: [kiss_icp, mine]

It gets the recording alone: one LiDAR and its IMU, no truth.
"""
import pathlib
import sys

import lidarena


def main(make, arguments=None):
    """Runs make(rig) over the recording and writes trajectory.tum and map.ply.

    `arguments` are [INPUT, OUTPUT], the command line's where not given. Exits 1 when the estimate
    diverged, 2 on wrong usage.
    """
    arguments = sys.argv[1:] if arguments is None else arguments
    if len(arguments) != 2:
        print("usage: INPUT OUTPUT, as a study's {input} {output}", file=sys.stderr)
        sys.exit(2)
    source, output = map(pathlib.Path, arguments)
    dataset = lidarena.open_dataset(source)
    result = lidarena.run(make(dataset.rig), dataset)
    if result.summary["diverged"]:
        print(result.summary["reason"], file=sys.stderr)
        sys.exit(1)
    points = result.map
    if len(points):
        lidarena.write_cloud(output / "map.ply", points)
    result.trajectory.write(output / "trajectory.tum")
