# SPDX-License-Identifier: BSD-3-Clause
"""Runs an odometry written in Python as an external program of a study.

    # my_odometry.py
    import lidarena, lidarena.external

    class Mine(lidarena.Odometry):
        def track(self, scan):
            ...
            return lidarena.ScanResult(scan.stamp, world_from_body)

    lidarena.external.main(lambda rig: Mine())

    # study.yaml
    external:
      - {name: mine, command: python3 my_odometry.py {input} {output}, pose_of: body}
    algorithms: [kiss_icp, mine]

The program gets only the recording of one LiDAR and its IMU, not the truth.
"""
import pathlib
import sys

import lidarena


def main(make, arguments=None):
    """Runs make(rig) over the recording and writes trajectory.tum and map.ply.

    `arguments` are [INPUT, OUTPUT]; default: the command line's. Exits with 1 if the estimate
    diverged, with 2 on wrong usage.
    """
    arguments = sys.argv[1:] if arguments is None else arguments
    if len(arguments) != 2:
        print("usage: INPUT OUTPUT (in a study: {input} {output})", file=sys.stderr)
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
