#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The search of the preset `tuned` of each published method: docs/results/tuning/plan.json.

usage: tuning.py study NAME [RESULTS.csv ...]    prints the study of this name, a file for
                                                 `lidarena study`; RESULTS.csv: of all stages before
       tuning.py tables RESULTS.csv ...          writes a table and a CSV of all tries per method,
                                                 from the results of all stages so far

Settings are ranked by the median over flights of the log of RPE (1 m, at the poses); a lost run
counts as 100 cm/m; ties go to the lower median CPU load. Raises PlanError, naming the setting, if a
setting lacks a flight of a stage or has a row twice.
"""
import argparse
import csv
import json
import math
import pathlib
import statistics
import sys

from renew_results import LOST, NAMES, is_lost, number_text

TUNING = pathlib.Path(__file__).resolve().parent / "results" / "tuning"
DRIFT = "rpe_1m_at_poses_translation_cm"


class PlanError(Exception):
    pass


def method_of(setting):
    return setting["as"].rsplit("-", 1)[0]


def drift_of(run):
    """RPE in cm per m; of a lost run the limit of a lost one."""
    return LOST[DRIFT] if is_lost(run) or not run[DRIFT] else float(run[DRIFT])


def flights_of(plan, stage):
    return [(scene["world"], seed, sensor) for scene in stage["scenes"]
            for seed in stage["seeds"] for sensor in plan["sensors"]]


def read_runs(files):
    """{setting: {(world, seed, sensor): run}}, without runs that a study has not flown yet."""
    found = {}
    for file in files:
        with open(file, newline="") as rows:
            for run in csv.DictReader(rows):
                if run["status"] == "missing":
                    continue
                flight = run["world"], int(run["seed"]), run["sensor"]
                if found.setdefault(run["algorithm"], {}).setdefault(flight, run) is not run:
                    raise PlanError(f"{file}: {run['algorithm']} has two rows of {flight}: "
                                    "give each results.csv once")
    return found


def score(runs):
    """(median of log RPE, median CPU load in percent) of these runs; the smaller, the better."""
    drift = statistics.median(math.log(max(drift_of(run), 1e-9)) for run in runs)
    return drift, statistics.median(float(run["cpu_load_percent"] or "inf") for run in runs)


def ranked(settings, runs, flights):
    """The settings, best first. Throws PlanError if one lacks a flight."""
    for setting in settings:
        missing = [flight for flight in flights if flight not in runs.get(setting["as"], {})]
        if missing:
            raise PlanError(f"{setting['as']} lacks {len(missing)} of {len(flights)} flights, the "
                            f"first {missing[0]}: fly its stage to the end, with --known")
    return sorted(settings, key=lambda setting: (
        *score([runs[setting["as"]][flight] for flight in flights]), setting["as"]))


def stages_flown(plan, runs):
    """The stages of which there are rows, from the first one on."""
    flown = []
    for stage in plan["stages"]:
        if not any(flight in of for of in runs.values() for flight in flights_of(plan, stage)):
            break
        flown.append(stage)
    return flown


def chosen(plan, runs, stages):
    """The settings that are left after these stages, best first within each method."""
    left, flights = plan["settings"], []
    for stage in stages:
        flights += flights_of(plan, stage)
        methods = {}
        for setting in left:
            methods.setdefault(method_of(setting), []).append(setting)
        left = [setting for of_method in methods.values()
                for setting in ranked(of_method, runs, flights)[:stage["keep"]]]
    return left


def study(plan, name, files):
    """The text of a stage's study: JSON, which is YAML, too."""
    names = [stage["study"] for stage in plan["stages"]]
    if name not in names:
        raise PlanError(f"the plan has no study '{name}': use one of {', '.join(names)}")
    stage = plan["stages"][names.index(name)]
    left = chosen(plan, read_runs(files), plan["stages"][:names.index(name)])
    return json.dumps({
        "title": f"Tuning of the published methods, {name}",
        "scenes": [{**scene, "seconds": plan["seconds"]} for scene in stage["scenes"]],
        "sensors": plan["sensors"], "new_scenes": True, "seeds": stage["seeds"],
        "score": ["trajectory"], "keep_maps": False, "algorithms": left}, indent=1) + "\n"


def setting_text(setting):
    preset = setting["name"].partition(":")[2] or setting["name"]
    values = [f"{key}={json.dumps(value)}" for key, value in setting.get("set", {}).items()]
    return ", ".join([preset, f"parts {setting.get('parts', 1)}", *values])


def tries(settings, runs, flights):
    """A row per setting: name, text, flights, lost, median RPE, median CPU load, RPE per flight."""
    rows = []
    for setting in settings:
        flown = runs.get(setting["as"], {})
        of_flight = [drift_of(flown[flight]) if flight in flown else None for flight in flights]
        done = [flown[flight] for flight in flights if flight in flown]
        log_drift, cpu = score(done) if done else (math.nan, math.nan)
        rows.append([setting["as"], setting_text(setting), len(done), sum(map(is_lost, done)),
                     math.exp(log_drift), cpu, *of_flight])
    return rows


def table_csv(rows, flights):
    head = ["setting", "values", "flights", "lost", "median_rpe_cm_per_m", "median_cpu_load_percent",
            *("-".join(map(str, flight)) for flight in flights)]
    lines = [head, *([f"{v:.9g}" if isinstance(v, float) else "" if v is None else v for v in row]
                     for row in rows)]
    return lines


def table_markdown(method, rows):
    lines = [f"# Tries of {NAMES.get(method, method)}", "",
             "All settings of the plan (`plan.json`), those that flew most first. RPE over 1 m in cm",
             "per m, median over the flights; a lost run counts as 100. Each flight's figure is in",
             f"`{method}.csv`.", "",
             "| | settings | flights | lost | RPE | CPU load, % |", "|---|---|---:|---:|---:|---:|"]
    lines += [f"| `{name}` | {text} | {flown} | {lost} | {number_text(drift)} | {number_text(cpu)} |"
              for name, text, flown, lost, drift, cpu, *_ in rows]
    return "\n".join(lines) + "\n"


def write_tables(plan, files, folder):
    runs = read_runs(files)
    stages = stages_flown(plan, runs)
    flights = [flight for stage in stages for flight in flights_of(plan, stage)]
    best = [setting["as"] for setting in chosen(plan, runs, stages)]
    for method in dict.fromkeys(map(method_of, plan["settings"])):
        settings = [setting for setting in plan["settings"] if method_of(setting) == method]
        rows = sorted(tries(settings, runs, flights), key=lambda row: (-row[2], row[4], row[5]))
        (folder / f"{method}.md").write_text(table_markdown(method, rows))
        with (folder / f"{method}.csv").open("w", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows(table_csv(rows, flights))
    return best


def main():
    parser = argparse.ArgumentParser(usage=__doc__, add_help=False)
    parser.add_argument("what", choices=["study", "tables"])
    parser.add_argument("files", nargs="*")
    parser.add_argument("--plan", type=pathlib.Path, default=TUNING / "plan.json")
    parser.add_argument("--out", type=pathlib.Path, default=TUNING)
    given = parser.parse_args()
    plan = json.loads(given.plan.read_text())
    if given.what == "study":
        if not given.files:
            parser.error("name a study")
        print(study(plan, given.files[0], given.files[1:]), end="")
    else:
        print("left:", ", ".join(write_tables(plan, given.files, given.out)))


if __name__ == "__main__":
    try:
        main()
    except (PlanError, OSError) as error:
        sys.exit(f"tuning.py: {error}")
