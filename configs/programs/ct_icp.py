#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs the program of CT-ICP on sweeps in PLY files and writes trajectory.tum.

usage: ct_icp.py INPUT OUTPUT [PROFILE]

INPUT has one folder with 000000.ply ... (x, y, z in m, t in ns since the scan's start) and times.txt (s). The program's
command line reads no such folder, but that of the data set KITTI-CARLA: Town01/frames/frame_0000.ply ...,
with x, y, z and a timestamp in s. PROFILE is a settings file of the program, of which `odometry_options` is used; without
it the program has its defaults.
"""
import pathlib
import re
import shutil
import struct
import subprocess
import sys

TYPES = {"char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I", "float": "f", "double": "d"}


def ply_rows(file):
    """The rows of a binary PLY file's only element, as maps from property to value."""
    data = file.read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    header = data[:end].decode("ascii")
    if "format binary_little_endian 1.0" not in header:
        sys.exit(f"{file}: not binary, little endian")
    count = int(re.search(r"^element \w+ (\d+)$", header, re.MULTILINE)[1])
    properties = re.findall(r"^property (\w+) (\w+)$", header, re.MULTILINE)
    row = struct.Struct("<" + "".join(TYPES[kind] for kind, _ in properties))
    names = [name for _, name in properties]
    for values in row.iter_unpack(data[end:end + count * row.size]):
        yield dict(zip(names, values))


def write_frame(file, rows, start):
    """A frame with absolute times in s; points without a return are at the origin and are left out."""
    points = [struct.pack("<fffd", r["x"], r["y"], r["z"], start + 1e-9 * r["t"])
              for r in rows if 0 < r["x"] ** 2 + r["y"] ** 2 + r["z"] ** 2 < float("inf")]
    file.write_bytes(("ply\nformat binary_little_endian 1.0\n"
                      f"element vertex {len(points)}\n"
                      "property float x\nproperty float y\nproperty float z\nproperty double timestamp\n"
                      "end_header\n").encode() + b"".join(points))


def options_of(profile):
    """The lines of `odometry_options` of a settings file."""
    found = re.search(r"^odometry_options:[^\n]*\n(?:(?:[ #][^\n]*)?\n)*", pathlib.Path(profile).read_text() + "\n", re.MULTILINE)
    return found[0] if found else sys.exit(f"{profile}: no odometry_options")


def main(given, output, profile=None):
    sweeps, = (file.parent for file in pathlib.Path(given).glob("*/times.txt"))
    frames = output / "input/Town01/frames"
    frames.mkdir(parents=True)
    starts = [float(line) for line in (sweeps / "times.txt").read_text().split()]
    for scan, start in enumerate(starts):
        write_frame(frames / f"frame_{scan:04}.ply", ply_rows(sweeps / f"{scan:06}.ply"), start)
    settings = output / "ct_icp.yaml"
    settings.write_text(f"""\
output_results: true
generate_directory_prefix: false
exit_early: false  # or it leaves without a trajectory where it ends itself
save_mid_frame: 0  # the poses of the scans' ends instead
output_dir: {output}/poses
dataset_options:
  - dataset: KITTI_CARLA
    root_path: {output}/input
    use_all_datasets: false
    sequence_options:
      - sequence_name: Town01
        max_num_frames: {len(starts)}
""" + (options_of(profile) if profile else ""))
    subprocess.run(["run_odometry", "-c", settings], check=True)
    shutil.rmtree(output / "input")
    with (output / "trajectory.tum").open("w") as file:
        for pose in ply_rows(next((output / "poses").glob("*.PLY"))):
            print(*(f"{pose[key]:.9f}" for key in ("dest_t", "x", "y", "z", "qx", "qy", "qz", "qw")), file=file)


if __name__ == "__main__":
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    main(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), *sys.argv[3:])
