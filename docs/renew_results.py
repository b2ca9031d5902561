#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Keeps the figures of the documentation equal to the studies' results.

usage: renew_results.py STUDY --as NAME   takes over the figures of the report in the folder STUDY
       renew_results.py SPEED.json        takes over what lidar_benchmark --benchmark_out=SPEED.json
                                          --benchmark_filter='measure|simulate|bare' has measured
       renew_results.py COSTS.tsv         takes over what .ci/run has written as build/ci_costs.tsv
       renew_results.py                   renews the pages from docs/results/data
       renew_results.py --check           fails if a page differs from docs/results/data, if the
                                          tables there are not those of the runs there, or if
                                          README or a page of docs/results has a decimal figure
                                          typed by hand

docs/results/data/NAME.csv has all runs of a study, NAME.json the tables of its report that pages
use. Between a line `<!-- table NAME KIND VARIANT -->` and `<!-- end -->` a page has such a table
(KIND: drift, map, ...; `KIND,KIND` for two in one; VARIANT: a preset, or `none`), between
`<!-- runs NAME -->` and `<!-- end -->` the number of runs, and in a line
`<!-- = NAME KIND VARIANT WORLD SENSOR METHOD -->1.2<!-- end -->` one figure.
docs/results/data/speed.json has the figures of lidar_benchmark: `<!-- speed measure -->`
and `<!-- speed simulate -->` are tables of them, `<!-- speed ROW FIGURE -->1.2<!-- end -->` is one,
`<!-- speed machine -->` the processor. `<!-- costs ci -->` is the table of docs/results/data/costs.tsv.
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
PAGES = [DOCS.parent / "README.md", DOCS / "performance.md",
         *sorted((DOCS / "results").glob("*.md"))]
NAMES = {"test_house": "House", "test_cave": "Cave", "house": "House", "cave": "Cave",
         "livox_mid360": "Mid-360", "ouster_os0_128": "OS0-128",
         "livox_mid360_vibrating": "Mid-360", "ouster_os0_128_vibrating": "OS0-128",
         "ouster_os0_128_same_imu": "OS0-128, IMU of the Mid-360",
         "livox_mid360_paper": "Mid-360", "ouster_os0_128_paper": "OS0-128",
         "edgar_mine": "Edgar mine", "lava_tube": "lava tube", "subt_cave": "SubT cave",
         "ltu_cave": "LTU cave", "darpa_cave": "DARPA cave",
         "ct_icp": "CT-ICP", "kiss_icp": "KISS-ICP", "lio_sam": "LIO-SAM",
         "lio_sam_lc": "LIO-SAM with loops", "fast_lio2": "FAST-LIO2"}
COLUMNS = {"drift": "rpe_1m_at_poses_translation_cm",
           "live-drift": "live_rpe_1m_at_poses_translation_cm", "map": "own_map_rmse_cm",
           "map-all": "reprojected_map_rmse_cm", "outliers": "own_map_outliers_percent",
           "outliers-all": "reprojected_map_outliers_percent",
           "map-vertices": "own_map_rmse_vertices_cm",
           "outliers-vertices": "own_map_outliers_vertices_percent", "cpu": "cpu_load_percent"}
LOST = {"own_map_outliers_percent": 50.0, "rpe_1m_at_poses_translation_cm": 100.0}
BLOCK = re.compile(r"(<!-- (table|runs|speed|costs|=) ([^>]*?) -->)(.*?)(<!-- end -->)", re.DOTALL)


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


BENCHMARKED = {"mid360": "Mid-360", "os0_128_2048": "OS0-128, 2048 x 10"}
EFFECTS = {"geometry": "geometry, rolling", "frozen": "geometry, frozen (no motion)",
           "range_noise": "+ range noise",
           "sheet": "+ near and weak-signal noise, angles, rounding, dropouts",
           "split_beam": "+ seven rays a beam, two echoes"}
LAYOUTS = {"si": "ours, 24 bytes per point", "driver": "the driver's"}


def speed_cell(value, name):
    if name in ("bare", "measured", "simulated", "items_per_second"):
        return f"{value / 1e6:.2f} M/s"
    return f"{value:.2f}" if name == "of_bare" else f"{value:.2g}"


def speed_table(kind, rows):
    """Markdown of the rows on one thread that begin with `kind`."""
    columns = {"measure": ["bare", "measured", "of_bare", "real_time"],
               "simulate": ["bare", "simulated", "of_bare"]}[kind]
    head = {"measure": "| sensor | what is simulated | bare | scan | of bare | times real time |",
            "simulate": "| sensor | noise | layout | bare | simulate | of bare |"}[kind]
    lines = [head, re.sub(r"[^|]+", "---", head)]
    for name, figures in rows.items():
        parts = name.split("/")
        if parts[0] != kind:
            continue
        labels = [BENCHMARKED[parts[1]], EFFECTS[parts[2]], *(LAYOUTS[p] for p in parts[3:])]
        lines.append("| " + " | ".join(
            labels + [speed_cell(figures[column], column) for column in columns]) + " |")
    return "\n".join(lines)


def speed(words):
    data = json.loads((DATA / "speed.json").read_text())
    if words == ["machine"]:
        return data["machine"]
    if len(words) == 1:
        return f"\n\n{speed_table(words[0], data['rows'])}\n\n"
    return speed_cell(data["rows"][words[0]][words[1]], words[1])


def take_over_speed(file):
    """The counters of the rows on one thread, and on which processor."""
    counters = ("bare", "measured", "simulated", "of_bare", "real_time", "items_per_second")
    rows = {}
    for row in json.loads(file.read_text())["benchmarks"]:
        name = re.sub(r"/(iterations:\d+|real_time)", "", row["name"])
        if name.endswith("threads:2"):
            continue
        rows[name.removesuffix("/threads:1")] = {k: row[k] for k in counters if k in row}
    cpu = pathlib.Path("/proc/cpuinfo").read_text()
    machine = re.search(r"model name\s*: (.*)", cpu)[1]
    (DATA / "speed.json").write_text(json.dumps({"machine": machine, "rows": rows}, indent=1) + "\n")


def costs():
    """Markdown of what each step of .ci/run took."""
    lines = ["| step | minutes | CPU-minutes |", "|---|---:|---:|"]
    steps = [line.split("\t") for line in (DATA / "costs.tsv").read_text().splitlines()]
    steps.append(["**all**"] + [sum(int(step[i]) for step in steps) for i in (1, 2)])
    for name, seconds, cpu in steps:
        lines.append(f"| {name} | {int(seconds) / 60:.1f} | {int(cpu) / 60:.1f} |")
    return "\n".join(lines)


def words_of(found):
    """The words of a mark, with an empty one for `none`."""
    return ["" if word == "none" else word for word in found[3].split()]


def renewed(page):
    def content(found):
        what, words = found[2], words_of(found)
        if what == "table":
            return f"{found[1]}\n\n{table(words[0], words[1].split(','), words[2])}\n\n{found[5]}"
        if what == "speed":
            return found[1] + speed(words) + found[5]
        if what == "costs":
            return f"{found[1]}\n\n{costs()}\n\n{found[5]}"
        text = str(len(runs_of(words[0]))) if what == "runs" else figure(*words)
        return found[1] + text + found[5]
    return BLOCK.sub(content, page)


def judged(run, column):
    """The figure of a run, infinite if it is lost (lidarena/results/lost.hpp), None if missing."""
    lost = run["status"] != "ok" or any(
        run[name] and float(run[name]) > limit for name, limit in LOST.items())
    return math.inf if lost else float(run[column]) if run[column] else None


def is_spread(text, values):
    """Whether "1.2 to 3.4, 8 of 8" says the best, the worst and how many of `values` were kept."""
    kept = [value for value in values if math.isfinite(value)]
    found = re.fullmatch(r"(?:(.*) to (.*), )?(\d+) of (\d+)", text)
    if not found or (int(found[3]), int(found[4])) != (len(kept), len(values)):
        return False
    return found[1] is None or all(
        shown == "lost" if math.isinf(value) else
        math.isclose(float(shown), value, rel_tol=0.006, abs_tol=1e-9)
        for shown, value in ((found[1], min(values)), (found[2], max(values))))


def faults_of(study):
    """Cells of the stored tables that are not the medians of the stored runs."""
    runs = runs_of(study)
    checked = 0
    for name, stored in tables_of(study).items():
        kind = next(k for k in sorted(COLUMNS, key=len, reverse=True) if name.startswith(k + "-"))
        world, variant = name[len(kind) + 1:].split("-", 1)
        preset, _, mode = variant.partition("-")
        for sensor, method, cell in cells_of(stored):
            values = [judged(run, COLUMNS[kind]) for run in runs
                      if (run["world"], run["sensor"], run["algorithm"]) == (world, sensor, method)
                      and run["preset"] in ("", preset) and run["mode"] == mode]
            values = [value for value in values if value is not None]
            median = statistics.median(values) if values else None
            checked += 1
            if median is not None and math.isinf(median):
                same = cell["text"] == "lost"
            elif median is not None:
                same = math.isclose(cell["value"], median, rel_tol=1e-6, abs_tol=1e-9)
            else:
                same = cell["value"] is None
            if not same or (values and not is_spread(cell["spread"], values)):
                yield f"{study}: {name}, {sensor}, {method}: {cell}, but the runs give {median}"
    if checked == 0:
        yield f"{study}: no table of it was compared with its runs"


def check():
    faults = [fault for file in sorted(DATA.glob("*.csv")) for fault in faults_of(file.stem)]
    for file in PAGES:
        page = file.read_text()
        if renewed(page) != page:
            faults.append(f"{file.name}: differs from docs/results/data, run docs/renew_results.py")
        if file.name != "performance.md":  # it also has figures of other programs
            by_hand = re.findall(r"(?<![\w.])\d+\.\d+(?![\w.])", BLOCK.sub("", page))
            faults += [f"{file.name}: {number} was typed by hand" for number in by_hand]
    return faults


def take_over(study, name):
    wanted = {(w[1], w[2]) for page in PAGES for found in BLOCK.finditer(page.read_text())
              for w in [words_of(found)] if w[0] == name and found[2] in ("table", "=")}
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
    if arguments.study and arguments.study.suffix == ".json":
        take_over_speed(arguments.study)
    elif arguments.study and arguments.study.suffix == ".tsv":
        shutil.copyfile(arguments.study, DATA / "costs.tsv")
    elif arguments.study:
        take_over(arguments.study, arguments.name or arguments.study.name)
    for page in PAGES:
        page.write_text(renewed(page.read_text()))


if __name__ == "__main__":
    main()
