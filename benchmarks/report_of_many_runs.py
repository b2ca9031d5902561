# SPDX-License-Identifier: BSD-3-Clause
"""Times `plan`, `status` and `report` on a made-up store of many runs, and measures their memory.

usage: report_of_many_runs.py PROGRAM CONFIGS FOLDER [CELLS] [--clouds]      10,000 cells by default; FOLDER must not exist

One real study of a small room gives a run of each algorithm. The store has copies of them with other figures, curves as
long as those of a flight of a minute, and no clouds (`keep_maps: false`) unless --clouds asks for them; three runs are left
out, and the report has to name them.
"""
import json
import os
import pathlib
import random
import subprocess
import sys
import time

FLIGHT = "kind: waypoints\nwaypoints: [[2, 2, 1.5], [10, 2, 1.2], [10, 7, 1.8], [2, 6.5, 1.5], [2, 2, 1.5]]\n"
CORNERS = [(x, y, z) for z in (0, 4) for y in (0, 8) for x in (0, 12)]
FACES = ["1 2 4 3", "5 6 8 7", "1 2 6 5", "3 4 8 7", "1 3 7 5", "2 4 8 6"]
ROOM = "".join(f"v {x} {y} {z}\n" for x, y, z in CORNERS) + "".join(f"f {f}\n" for f in FACES)
ALGORITHMS = ("kiss_icp", "ct_icp", "fast_lio2", "arena_lo", "arena_lio")
SENSORS = ("livox_mid360", "ouster_os0_128")
SCANS = 600
MISSING = 3


def measured(*command):
    """Exit code, seconds and peak memory in MB of a command."""
    begin = time.monotonic()
    pid = os.spawnvp(os.P_NOWAIT, "sh", ["sh", "-c", 'exec "$@" >/dev/null', "sh", *map(str, command)])
    _, status, usage = os.wait4(pid, 0)
    return os.waitstatus_to_exitcode(status), time.monotonic() - begin, usage.ru_maxrss / 1e3


def study_text(here, seeds, worlds, clouds):
    scenes = ", ".join(f"{{world: {here}/{world}.obj, flight: {here}/flight.yaml, seconds: {8 if clouds else 1}}}" for world in worlds)
    return (f"title: Many runs\nscenes: [{scenes}]\nseeds: {list(range(1, seeds + 1))}\nsensors: [{', '.join(SENSORS)}]\n"
            f"algorithms: [{', '.join(ALGORITHMS)}]\nkeep_maps: {str(clouds).lower()}\n")


def stretched(value, dice):
    """The metrics with other figures, and with curves of SCANS values."""
    if isinstance(value, dict):
        if "t_s" in value:
            keys = [key for key in value if isinstance(value[key], list)]
            return {**value, **{key: [round(0.1 * i, 3) if key == "t_s" else round(0.05 * dice.random(), 6)
                                      for i in range(SCANS)] for key in keys}}
        return {key: stretched(entry, dice) for key, entry in value.items()}
    if isinstance(value, float):
        return value * dice.uniform(0.8, 1.25)
    return value


def fill(study, template):
    """Writes the folders of the planned runs and their datasets."""
    plan = json.loads((study / "plan.json").read_text())
    dice = random.Random(1)
    steps = {}
    for run in plan["runs"]:
        steps.setdefault((run["sensor"], run["algorithm"]), template / "runs" / run["name"].replace(run["dataset"], "room-flight-s1"))
    units = {unit["dataset"]: unit["flight"] for unit in plan["units"]}
    for name, flight in units.items():
        folder = study / "datasets" / name
        folder.mkdir(parents=True)
        for file in ("manifest.json", "truth.tum"):
            (folder / file).write_bytes((template / "datasets/room-flight-s1" / file).read_bytes())
        if not (study / "worlds/w.ply").exists():
            (study / "worlds").mkdir()
            (study / "worlds/w.ply").write_bytes((template / "datasets/room-flight-s1/world.ply").read_bytes())
        (folder / "world.ply").symlink_to("../../worlds/w.ply")
    for run in plan["runs"][:-MISSING]:
        source, folder = steps[run["sensor"], run["algorithm"]], study / "runs" / run["name"]
        folder.mkdir(parents=True)
        request = json.loads((source / "request.json").read_text())
        request["run"].update(flight=units[run["dataset"]], cell=run)
        (folder / "request.json").write_text(json.dumps(request))
        manifest = json.loads((source / "manifest.json").read_text())
        manifest["dataset"] = f"../../datasets/{run['dataset']}"
        (folder / "manifest.json").write_text(json.dumps(manifest))
        for file in source.iterdir():
            if file.suffix in (".tum", ".ply") or file.name in ("resources.json", "events.csv"):
                os.link(file, folder / file.name)
        head, *rows = (source / "resources.csv").read_text().splitlines()
        (folder / "resources.csv").write_text("\n".join([head, *(rows * SCANS)[:SCANS]]) + "\n")
        (folder / "metrics.json").write_text(json.dumps(stretched(json.loads((source / "metrics.json").read_text()), dice)))


def main():
    words = [word for word in sys.argv[1:] if word != "--clouds"]
    clouds = "--clouds" in sys.argv
    program, configs, folder = words[0], words[1], pathlib.Path(words[2]).absolute()
    cells = int(words[3]) if len(words) > 3 else 10_000
    folder.mkdir(parents=True)
    for world in ("room", "hall"):
        (folder / f"{world}.obj").write_text(ROOM)
    (folder / "flight.yaml").write_text(FLIGHT)
    (folder / "small.yaml").write_text(study_text(folder, 1, ["room"], clouds))
    seeds = cells // (2 * len(SENSORS) * len(ALGORITHMS))
    (folder / "many.yaml").write_text(study_text(folder, seeds, ["room", "hall"], clouds))
    common = ["--configs", configs, "--quiet"]
    subprocess.run([program, "study", folder / "small.yaml", "--out", folder / "small", *common], check=True,
                   stdout=subprocess.DEVNULL)
    study = folder / "many"
    figures = {"plan": measured(program, "study", folder / "many.yaml", "--out", study, "--slurm", "--print", *common)}
    fill(study, folder / "small")
    figures["status"] = measured(program, "status", study)
    figures["report"] = measured(program, "report", study, "--quiet")
    planned = len(json.loads((study / "plan.json").read_text())["runs"])
    rows = (study / "results.csv").read_text()
    assert rows.count("\n") == planned + 1 and rows.count(",missing,") == MISSING, "a row is missing"
    assert figures["report"][0] == 1, "the report has to exit with 1, since runs are missing"
    for what, (_, seconds, megabytes) in figures.items():
        print(f"{planned} runs: {what}: {seconds:.1f} s, {megabytes:.0f} MB")
    print(f"page: {(study / 'report.html').stat().st_size / 1e6:.1f} MB")


if __name__ == "__main__":
    main()
