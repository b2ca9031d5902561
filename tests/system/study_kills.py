# SPDX-License-Identifier: BSD-3-Clause
"""Kills a running study at random instants and lets it continue, until it ends with the results of an undisturbed one.

usage: study_kills.py PROGRAM CONFIGS [KILLS [SEED]]

Every second kill hits a program that the study has started, the others the study itself. After each kill, every file with
its final name must be the file of the undisturbed study; at the end, all must be there, without data or unfinished files.
"""
import json
import pathlib
import random
import signal
import subprocess
import sys
import tempfile
import time

TIMED = {"manifest.json", "resources.csv", "resources.json", "lidarena.log", "request.json"}
FLIGHT = "kind: waypoints\nwaypoints: [[2, 2, 1.5], [10, 2, 1.2], [10, 7, 1.8], [2, 6.5, 1.5], [2, 2, 1.5]]\n"
CORNERS = [(x, y, z) for z in (0, 4) for y in (0, 8) for x in (0, 12)]
FACES = ["1 2 4 3", "5 6 8 7", "1 2 6 5", "3 4 8 7", "1 3 7 5", "2 4 8 6"]
ROOM = "".join(f"v {x} {y} {z}\n" for x, y, z in CORNERS) + "".join(f"f {f}\n" for f in FACES)


def files_of(study):
    """Files with their final name that do not tell times, by their path in the study."""
    found = {}
    for part in ("datasets", "runs"):
        for file in (study / part).rglob("*"):
            if file.is_file() and file.name not in TIMED and file.suffix not in (".part", ".mcap", ".yaml"):
                found[str(file.relative_to(study))] = file
    return found


def children_of(pid):
    """Programs that a process has started."""
    try:
        ids = pathlib.Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
    except OSError:
        return []
    return [int(i) for i in ids]


def kill_at(process, instant, child):
    """Kills the process, or one of its children, after `instant` seconds; false if it had ended."""
    begin = time.monotonic()
    while time.monotonic() - begin < instant and process.poll() is None:
        time.sleep(0.005)
    victims = children_of(process.pid) if child else [process.pid]
    if process.poll() is not None or not victims:
        return False
    subprocess.run(["kill", "-9", str(victims[0])], check=False)
    if not child:
        process.wait()
    return True


def check_whole(study, reference):
    for name, file in files_of(study).items():
        assert name in reference, f"{name} is not a file of the undisturbed study"
        assert file.read_bytes() == reference[name].read_bytes(), f"{name} differs"


def main():
    program, configs = sys.argv[1:3]
    kills = int(sys.argv[3]) if len(sys.argv) > 3 else 20
    dice = random.Random(int(sys.argv[4]) if len(sys.argv) > 4 else 1)
    with tempfile.TemporaryDirectory() as folder:
        here = pathlib.Path(folder)
        (here / "room.obj").write_text(ROOM)
        (here / "flight.yaml").write_text(FLIGHT)
        (here / "study.yaml").write_text(
            f"scenes: [{{world: {here}/room.obj, flight: {here}/flight.yaml, seconds: 1}}]\nseeds: [1, 2]\n"
            "sensors: [livox_mid360]\nalgorithms: [kiss_icp, fast_lio2]\n")

        def call(out):
            return [program, "study", str(here / "study.yaml"), "--out", str(here / out), "--configs", configs,
                    "--json", "--quiet", "--jobs", "2"]

        begin = time.monotonic()
        subprocess.run(call("calm"), check=True, stdout=subprocess.DEVNULL)
        duration = time.monotonic() - begin
        reference = files_of(here / "calm")
        assert sum(name.endswith("metrics.json") for name in reference) == 4, sorted(reference)

        done = calls = 0
        while done < kills:
            calls += 1
            if calls % 5 == 0:  # otherwise nothing would be left to kill
                subprocess.run(["rm", "-r", str(here / "killed" / "runs")], check=False)
            with subprocess.Popen(call("killed"), stdout=subprocess.PIPE, stderr=subprocess.PIPE) as study:
                child = calls % 2 == 0
                killed = kill_at(study, dice.uniform(0, duration), child)
                done += killed
                error = study.communicate()[1].decode()
            if study.returncode == 1:  # the child was the program asked for its version, without which there is no plan
                assert killed and child and "--version --json: killed by signal 9" in error, error
            else:
                assert study.returncode in (0, -signal.SIGKILL), error
            if (here / "killed").exists():
                check_whole(here / "killed", reference)
            print(f"call {calls}: {done} kills", flush=True)
        for _ in range(2):  # a cell that was killed is a failed one, which the next call repeats
            last = json.loads(subprocess.run(call("killed"), check=True, stdout=subprocess.PIPE).stdout)
        assert last["failed"] == 0 and last["runs"] == last["reused"] == 4, last
        check_whole(here / "killed", reference)
        assert files_of(here / "killed").keys() == reference.keys()
        left = [f for pattern in ("*.part", "*.mcap") for f in (here / "killed").rglob(pattern)]
        assert not left, left
        print(f"{done} kills in {calls} calls; an undisturbed study takes {duration:.1f} s")


if __name__ == "__main__":
    main()
