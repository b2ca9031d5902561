#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Keeps the figures of the documentation equal to the studies' results.

usage: renew_results.py STUDY --as NAME   takes over the figures of the report in the folder STUDY
       renew_results.py                   renews the pages from docs/results/data
       renew_results.py --check           fails if a page differs from docs/results/data, if the
                                          tables there are not those of the runs there, or if a
                                          page of docs/results has a decimal figure typed by hand

docs/results/data/NAME.csv has all runs of a study, NAME.json the tables of its report that pages
use. Between a line `<!-- table NAME KIND VARIANT -->` and `<!-- end -->` a page has such a table
(KIND: drift, map, ...; `KIND,KIND` for two in one), between `<!-- runs NAME -->` and `<!-- end -->`
the number of runs, and in a line `<!-- = NAME KIND VARIANT WORLD SENSOR METHOD -->1.2<!-- end -->`
one figure.
"""
import argparse
import csv
import json
import math
import pathlib
import re
import shutil
import statistics
import sys

DOCS = pathlib.Path(__file__).resolve().parent
DATA = DOCS / "results" / "data"
PAGES = [DOCS.parent / "README.md", *sorted((DOCS / "results").glob("*.md"))]
NAMES = {"test_house": "House", "test_cave": "Cave", "house": "House", "cave": "Cave",
         "livox_mid360": "Mid-360", "ouster_os0_128": "OS0-128",
         "livox_mid360_vibrating": "Mid-360", "ouster_os0_128_vibrating": "OS0-128",
         "ouster_os0_128_same_imu": "OS0-128, IMU of the Mid-360",
         "livox_mid360_paper": "Mid-360", "ouster_os0_128_paper": "OS0-128",
         "ct_icp": "CT-ICP", "kiss_icp": "KISS-ICP", "lio_sam": "LIO-SAM",
         "lio_sam_lc": "LIO-SAM with loops", "fast_lio2": "FAST-LIO2"}
COLUMNS = {"drift": "rpe_1m_at_poses_translation_cm",
           "live-drift": "live_rpe_1m_at_poses_translation_cm", "map": "own_map_rmse_cm",
           "map-all": "reprojected_map_rmse_cm", "outliers": "own_map_outliers_percent",
           "outliers-all": "reprojected_map_outliers_percent", "cpu": "cpu_load_percent"}
LOST = {"own_map_outliers_percent": 50.0, "rpe_1m_at_poses_translation_cm": 100.0}
BLOCK = re.compile(r"(<!-- (table|runs|=) ([^>]*?) -->)(.*?)(<!-- end -->)", re.DOTALL)


def tables_of(study):
    return json.loads((DATA / (study + ".json")).read_text())


def runs_of(study):
    with (DATA / (study + ".csv")).open(newline="") as file:
        return list(csv.DictReader(file))


def cells_of(table):
    """The cells of a report's table of sensors and methods."""
    for row in table["rows"]:
        for method, cell in zip(table["head"][1:], row[1:]):
            yield row[0]["text"], method, cell


def shown(cell, short=False):
    text = cell["text"] or "-"
    if cell.get("underlined"):
        text = f"<u>{text}</u>"
    if cell.get("bold"):
        text = f"**{text}**"
    spread = cell.get("spread", "")
    if short:
        kept, runs = re.search(r"(\d+) of (\d+)$", spread).groups()
        return text if kept == runs else f"{text} ({kept} of {runs})"
    return f"{text} ({spread})" + (f" [{cell['reference']}]" if cell.get("reference") else "")


def table(study, kinds, variant):
    """Markdown with a row for each method and a column for each world and sensor."""
    all_tables = tables_of(study)
    columns, methods, texts = [], [], {}
    for name in all_tables:
        if not name.startswith(kinds[0] + "-") or not name.endswith("-" + variant):
            continue
        world = name[len(kinds[0]) + 1:-len(variant) - 1]
        if world not in NAMES:
            continue  # of a kind whose name begins alike
        for kind in kinds:
            for sensor, method, cell in cells_of(all_tables[f"{kind}-{world}-{variant}"]):
                if (world, sensor) not in columns:
                    columns.append((world, sensor))
                if method not in methods:
                    methods.append(method)
                texts.setdefault((world, sensor, method), []).append(shown(cell, len(kinds) > 1))
    head = [f"{NAMES[world]}, {NAMES[sensor]}" for world, sensor in columns]
    lines = ["| | " + " | ".join(head) + " |", "|---|" + "---:|" * len(head)]
    for method in methods:
        row = [" / ".join(texts.get((*column, method), ["-"])) for column in columns]
        lines.append(f"| {NAMES.get(method, '`' + method + '`')} | " + " | ".join(row) + " |")
    return "\n".join(lines)


def figure(study, kind, variant, world, sensor, method):
    for of_sensor, of_method, cell in cells_of(tables_of(study)[f"{kind}-{world}-{variant}"]):
        if (of_sensor, of_method) == (sensor, method):
            return cell["text"]
    raise KeyError((world, sensor, method))


def renewed(page):
    def content(found):
        what, words = found[2], found[3].split()
        if what == "table":
            return f"{found[1]}\n\n{table(words[0], words[1].split(','), words[2])}\n\n{found[5]}"
        text = str(len(runs_of(words[0]))) if what == "runs" else figure(*words)
        return found[1] + text + found[5]
    return BLOCK.sub(content, page)


def judged(run, column):
    """The figure of a run, infinite if it is lost (lidarena/results/lost.hpp), None if missing."""
    lost = run["status"] != "ok" or any(
        run[name] and float(run[name]) > limit for name, limit in LOST.items())
    return math.inf if lost else float(run[column]) if run[column] else None


def faults_of(study):
    """Cells of the stored tables that are not the medians of the stored runs."""
    runs = runs_of(study)
    checked = 0
    for name, stored in tables_of(study).items():
        kind = next(k for k in sorted(COLUMNS, key=len, reverse=True) if name.startswith(k + "-"))
        world, variant = name[len(kind) + 1:].rsplit("-", 1)
        for sensor, method, cell in cells_of(stored):
            values = [judged(run, COLUMNS[kind]) for run in runs
                      if (run["world"], run["sensor"], run["algorithm"]) == (world, sensor, method)
                      and run["preset"] in ("", variant)]
            values = [value for value in values if value is not None]
            median = statistics.median(values) if values else None
            kept = sum(math.isfinite(value) for value in values)
            checked += 1
            if median is not None and math.isinf(median):
                same = cell["text"] == "lost"
            elif median is not None:
                same = math.isclose(cell["value"], median, rel_tol=1e-6, abs_tol=1e-9)
            else:
                same = cell["value"] is None
            if not same or (values and not cell["spread"].endswith(f"{kept} of {len(values)}")):
                yield f"{study}: {name}, {sensor}, {method}: {cell}, but the runs give {median}"
    if checked == 0:
        yield f"{study}: no table of it was compared with its runs"


def check():
    faults = [fault for file in sorted(DATA.glob("*.csv")) for fault in faults_of(file.stem)]
    for file in PAGES:
        page = file.read_text()
        if renewed(page) != page:
            faults.append(f"{file.name}: differs from docs/results/data, run docs/renew_results.py")
        if file.parent.name == "results":
            by_hand = re.findall(r"(?<![\w.])\d+\.\d+(?![\w.])", BLOCK.sub("", page))
            faults += [f"{file.name}: {number} was typed by hand" for number in by_hand]
    return faults


def take_over(study, name):
    wanted = {(w[1], w[2]) for page in PAGES for found in BLOCK.finditer(page.read_text())
              for w in [found[3].split()] if w[0] == name and found[2] != "runs"}
    kinds = {(kind, variant) for kinds, variant in wanted for kind in kinds.split(",")}
    tables = {}
    for file in sorted((study / "tables").glob("*.json")):
        if any(re.fullmatch(f"{kind}-({'|'.join(NAMES)})-{variant}", file.stem)
               for kind, variant in kinds):
            tables[file.stem] = json.loads(file.read_text())
            del tables[file.stem]["note"]
    if not tables:
        sys.exit(f"{study} has no table that a page shows as {name}; make its report, or mark a "
                 "place in a page")
    DATA.mkdir(exist_ok=True)
    (DATA / (name + ".json")).write_text(json.dumps(tables, indent=1) + "\n")
    shutil.copyfile(study / "results.csv", DATA / (name + ".csv"))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("study", type=pathlib.Path, nargs="?")
    parser.add_argument("--as", dest="name")
    parser.add_argument("--check", action="store_true")
    arguments = parser.parse_args()
    if arguments.check:
        faults = check()
        print(*faults, sep="\n")
        sys.exit(1 if faults else 0)
    if arguments.study:
        take_over(arguments.study, arguments.name or arguments.study.name)
    for page in PAGES:
        page.write_text(renewed(page.read_text()))


if __name__ == "__main__":
    main()
