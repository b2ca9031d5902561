#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Keeps the figures of the documentation equal to the studies' results.

usage: renew_results.py STUDY --as NAME   takes over the figures of the report in the folder STUDY
       renew_results.py SPEED.json        takes over what lidar_benchmark --benchmark_out=SPEED.json
                                          --benchmark_filter='measure|simulate|bare' has measured
       renew_results.py COSTS.tsv         takes over what .ci/run has written as build/ci_costs.tsv
       renew_results.py                   renews the pages from docs/results/data
       renew_results.py --judge           computes the cells of the tables there from the runs there
                                          anew, after a change of what a lost run is
       renew_results.py --check           fails if a page differs from docs/results/data, if the
                                          tables there are not those of the runs there, or if
                                          README or a page of docs/results has a decimal figure
                                          typed by hand

docs/results/data/NAME.csv has all runs of a study, NAME.json the tables of its report that pages
use. Between a line `<!-- table NAME KIND VARIANT -->` and `<!-- end -->` a page has such a table
(KIND: drift, map, ...; `KIND,KIND` for two in one; VARIANT: a preset, or `none`; names of methods may
follow, for a table of these alone, without ranges), between
`<!-- runs NAME -->` and `<!-- end -->` the number of runs, and in a line
`<!-- = NAME KIND VARIANT WORLD SENSOR METHOD -->1.2<!-- end -->` one figure (KIND `live`: the live drift
beside the final one).
`<!-- median NAME COLUMN METHOD WORLD SENSOR -->` is the median of a column of the runs that ratios compare.
`<!-- ratio NAME KIND SENSOR METHOD SENSOR METHOD WORLD -->` is how many times the figure of the second cell
is that of the first, with the interval at 95 % (docs/ratios.py; WORLD `none`: over all; KIND `live-over-final`: the
first's final drift, the second's live one), and
`<!-- ratios METHOD METHOD STUDY ... -->` the table of such ratios of the drift in studies.
docs/results/data/needs/NAME.json has tables of the report of a study that varies settings: `<!-- report NAME ID=HEAD ... -->`
puts tables with the same rows side by side (HEAD with _ for blanks). FINAL_ID/LIVE_ID=HEAD has both in each cell.
`<!-- presets KIND STUDY ... -->` has the medians of each method and preset, over the seeds that all these studies have.
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

import paper_protocol
import ratios
import report_tables
import targets

DOCS = pathlib.Path(__file__).resolve().parent
DATA = DOCS / "results" / "data"
NEEDS = DATA / "needs"  # studies that vary settings
PAGES = [DOCS.parent / "README.md", DOCS / "features.md", DOCS / "performance.md", DOCS / "machines.md",
         *sorted((DOCS / "results").glob("*.md"))]
NAMES = {"test_house": "House", "test_cave": "Cave", "house": "House", "cave": "Cave",
         "livox_mid360": "Mid-360", "ouster_os0_128": "OS0-128",
         "livox_mid360_down": "Mid-360 below", "arena_lio_two": "`arena_lio` with both",
         "livox_mid360_harsh": "Mid-360", "ouster_os0_128_harsh": "OS0-128",
         "mid360_recorded_imu": "Mid-360", "os0_recorded_imu": "OS0-128",
         "dev_mine": "mine", "dev_forest": "forest", "dev_hall": "hall", "dev_office": "office",
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
LOST = {"rpe_1m_at_poses_translation_cm": 100.0, "rpe_1m_at_poses_rotation_deg": 20.0}
PATH = [*LOST, "live_rpe_1m_at_poses_translation_cm", "ate_se3_translation_cm"]
MIN_SEEDS = 16  # of a mark, within a world; two flights of a seed share its world
KINDS = {"drift": "drift, final / live", "live-drift": "live drift", "map": "own map"}
BLOCK = re.compile(r"(<!-- (table|runs|report|speed|costs|median|ratios|ratio|presets|=) ([^>]*?) -->)(.*?)(<!-- end -->)", re.DOTALL)


def tables_of(study):
    return json.loads((DATA / (study + ".json")).read_text())


def runs_of(study):
    file = DATA / (study + ".csv")
    with (file if file.exists() else NEEDS / (study + ".csv")).open(newline="") as rows:
        return list(csv.DictReader(rows))


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
    if cell.get("live"):
        text = f"{text} / {cell['live']} live"
    spread = cell.get("spread", "")
    if short:
        kept, runs = re.search(r"(\d+) of (\d+)$", spread).groups()
        return text if kept == runs else f"{text} ({kept} of {runs})"
    return f"{text} ({spread})" + (f" [{cell['reference']}]" if cell.get("reference") else "")


def table(study, kinds, variant, *only):
    """Markdown with a row for each method and a column for each world and sensor; with names of
    methods in `only`, a row for each of these, in their order."""
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
                short = len(kinds) > 1 or bool(only)
                texts.setdefault((world, sensor, method), []).append(shown(cell, short))
    head = [f"{NAMES[world]}, {NAMES[sensor]}" for world, sensor in columns]
    what = "; ".join(KINDS.get(kind, "") for kind in kinds)
    lines = [f"| {what} | " + " | ".join(head) + " |", "|---|" + "---:|" * len(head)]
    for method in only or methods:
        row = ["; ".join(texts.get((*column, method), ["-"])) for column in columns]
        lines.append(f"| {NAMES.get(method, '`' + method + '`')} | " + " | ".join(row) + " |")
    return "\n".join(lines)


def figure(study, kind, variant, world, sensor, method):
    part = "live" if kind == "live" else "text"
    name = "drift" if kind == "live" else kind
    for of_sensor, of_method, cell in cells_of(tables_of(study)[f"{name}-{world}-{variant}"]):
        if (of_sensor, of_method) == (sensor, method):
            return cell[part]
    raise KeyError((world, sensor, method))


def compared(study):
    """The runs of a study that ratios compare: of published methods those with `tuned`, if it has such, else with `indoor`."""
    runs = runs_of(study)
    preset = "tuned" if any(run["preset"] == "tuned" for run in runs) else "indoor"
    return [run for run in runs if run["preset"] in ("", preset)]


def median_text(study, column, method, world, sensor):
    values = [judged(run, column) for run in compared(study)
              if (run["algorithm"], run["world"], run["sensor"]) == (method, world, sensor)]
    return f"{statistics.median(values):.3g}"


def pairs_of(study, kind, first, second, world):
    """(world, figure of the first, of the second) of the runs on the same flight and seed."""
    runs = compared(study)

    def figures(cell, column):
        return {(run["world"], run["flight"], run["mode"], run["seed"]): judged(run, column)
                for run in runs if (run["sensor"], run["algorithm"]) == cell and world in ("", run["world"])}
    kinds = ("drift", "live-drift") if kind == "live-over-final" else (kind, kind)
    a, b = figures(first, COLUMNS[kinds[0]]), figures(second, COLUMNS[kinds[1]])
    return [(key[0], a[key], b[key]) for key in a
            if None not in (a[key], b.get(key))]


def ratio_text(study, kind, first, second, world):
    strata = ratios.strata_of(pairs_of(study, kind, first, second, world))
    if not strata:
        return "-"
    found, interval = ratios.ratio(strata)
    shown = ["lost" if math.isinf(value) else f"{value:.2g}" if value < 10 else f"{value:.0f}"
             for value in (found, *(interval or ()))]
    return f"{shown[0]} ({shown[1]} to {shown[2]})" if interval else shown[0]


def ratios_table(second, first, *studies):
    """Markdown: in each study, world and sensor the drift of `second` over that of `first`."""
    lines = ["| study | world, sensor | pairs | final | live |", "|---|---|---:|---:|---:|"]
    for study in studies:
        both = [{(run["world"], run["sensor"]) for run in compared(study) if run["algorithm"] == method}
                for method in (first, second)]
        for world, sensor in sorted(both[0] & both[1]):
            cells = (sensor, first), (sensor, second)
            pairs = sum(map(len, ratios.strata_of(pairs_of(study, "drift", *cells, world))))
            texts = [ratio_text(study, kind, *cells, world) for kind in ("drift", "live-drift")]
            lines.append(f"| `{study}` | {NAMES[world]}, {NAMES[sensor]} | {pairs} | "
                         + " | ".join(texts) + " |")
    return "\n".join(lines)


def presets_table(kind, *studies):
    """Markdown: a row for each method and preset, a column for each world and sensor."""
    seeds = set.intersection(*({run["seed"] for run in runs_of(study)} for study in studies))
    runs = [run for study in studies for run in runs_of(study) if run["seed"] in seeds]
    columns = sorted({(run["world"], run["sensor"]) for run in runs})
    lines = [f"| {KINDS[kind].partition(',')[0]} | preset | " + " | ".join(f"{NAMES[w]}, {NAMES[s]}" for w, s in columns) + " |",
             "|---|---|" + "---:|" * len(columns)]
    for method in dict.fromkeys(run["algorithm"] for run in runs):
        for preset in dict.fromkeys(run["preset"] for run in runs if run["algorithm"] == method):
            row = []
            for column in columns:
                values = values_of([run for run in runs if (run["algorithm"], run["preset"], run["world"], run["sensor"])
                                    == (method, preset, *column)], COLUMNS[kind])
                kept = sum(map(math.isfinite, values))
                row.append(number_text(statistics.median(values)) + (f" ({kept} of {len(values)})" if kept < len(values) else ""))
            title = f"{NAMES[method]} | `{preset}`" if preset else f"`{method}` |"
            lines.append(f"| {title} | " + " | ".join(row) + " |")
    return "\n".join(lines)


BENCHMARKED = {"mid360": "Mid-360", "os0_128_2048": "OS0-128, 2048 x 10"}
EFFECTS = {"geometry": "geometry, rolling", "frozen": "geometry, frozen (no motion)",
           "range_noise": "+ range noise",
           "sheet": "+ near and weak-signal noise, angles, rounding, dropouts",
           "split_beam": "+ seven rays a beam, two echoes",
           **{"sheet_" + effect: "the line with dropouts + " + what for effect, what in {
               "bias": "bias of ranges and directions", "clock": "clock of the LiDAR",
               "shake": "vibration that moves the LiDAR", "movers": "five people",
               "drift": "warm-up", "air": "fog and rain", "bounces": "a wet floor, two bounces",
               "blooming": "blooming beside signs",
               "harsh": "bias, clock, vibration, warm-up and people"}.items()}}
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
            return f"{found[1]}\n\n{table(words[0], words[1].split(','), *words[2:])}\n\n{found[5]}"
        if what == "report":
            made = report_tables.side_by_side(stored_report(words[0]), words[1:], NAMES)
            return f"{found[1]}\n\n{made}\n\n{found[5]}"
        if what == "speed":
            return found[1] + speed(words) + found[5]
        if what == "costs":
            return f"{found[1]}\n\n{costs()}\n\n{found[5]}"
        if what == "median":
            return found[1] + median_text(*words) + found[5]
        if what in ("ratios", "presets"):
            made = {"ratios": ratios_table, "presets": presets_table}[what](*words)
            return f"{found[1]}\n\n{made}\n\n{found[5]}"
        if what == "ratio":
            text = ratio_text(words[0], words[1], tuple(words[2:4]), tuple(words[4:6]), words[6])
            return found[1] + text + found[5]
        text = str(len(runs_of(words[0]))) if what == "runs" else figure(*words)
        return found[1] + text + found[5]
    return BLOCK.sub(content, page)


def number_text(value):
    """As lidarena/results/table.cpp writes it: three significant digits, whole numbers in full."""
    if math.isinf(value):
        return "lost"
    size = abs(value)
    if 1 <= size < 1e6 and size == math.floor(size):
        return f"{value:.0f}"
    if 0 < size < 1e-3:
        return f"{value:.2e}"
    if size < 1:
        return f"{value:.3g}"
    return f"{value:.{max(0, 3 - int(math.log10(size)) - 1)}f}"


def is_lost(run):
    """As lidarena/results/lost.hpp says."""
    figures = {name: float(run[name]) for name in PATH if run[name]}
    return (run["status"] != "ok" or not all(map(math.isfinite, figures.values())) or
            any(figures.get(name, 0.0) > limit for name, limit in LOST.items()))


def judged(run, column):
    """The figure of a run, infinite if it is lost, None if missing."""
    return math.inf if is_lost(run) else float(run[column]) if run[column] else None


def ended_text(runs):
    """When the lost ones of these runs ended themselves; empty if one did not. Files of earlier
    versions have no `ended_at_s`, but the scan."""
    lost = [run for run in runs if is_lost(run)]
    times = [float(run["ended_at_s"]) for run in lost if run.get("ended_at_s")]
    scans = [int(found[1]) for run in lost
             if (found := re.match(r"scan (\d+): ", run["reason"]))]
    if lost and len(times) == len(lost):
        text = f"ended at {statistics.median(times):.1f} s"
        drifts = [float(run[COLUMNS["drift"]]) for run in lost if run[COLUMNS["drift"]]]
        return f"{text} [{number_text(statistics.median(drifts))}]" if drifts else text
    return f"ended at scan {statistics.median(scans):.0f}" if lost and len(scans) == len(lost) else ""


def runs_of_cell(runs, table_name, sensor, method):
    """The kind of a stored table's cell and its runs."""
    kind = next(k for k in sorted(COLUMNS, key=len, reverse=True) if table_name.startswith(k + "-"))
    world, variant = table_name[len(kind) + 1:].split("-", 1)
    preset, _, mode = variant.partition("-")
    return kind, [
        run for run in runs
        if (run["world"], run["sensor"], run["algorithm"]) == (world, sensor, method)
        and run["preset"] in ("", preset) and run["mode"] == mode]


def values_of(runs, column):
    return [value for run in runs if (value := judged(run, column)) is not None]


def spread_text(values):
    kept = [value for value in values if math.isfinite(value)]
    count = f"{len(kept)} of {len(values)}"
    if not kept or len(values) == 1:
        return count
    return f"{number_text(min(values))} to {number_text(max(values))}, {count}"


def lost_text(kind, runs):
    text = ended_text(runs) or "lost"
    return text if kind == "drift" else text.partition(" [")[0]


def live_text(kind, runs):
    """The median of the live drift, beside a final one that is not lost."""
    values = values_of(runs, COLUMNS["live-drift"]) if kind == "drift" else []
    median = statistics.median(values) if values else math.inf
    return number_text(median) if math.isfinite(median) else ""


def judge(study):
    """Computes the cells of the stored tables from the stored runs. Without 16 pairs in its world
    no cell is marked."""
    tables = tables_of(study)
    runs = runs_of(study)
    for name, stored in tables.items():
        for sensor, method, cell in cells_of(stored):
            kind, some = runs_of_cell(runs, name, sensor, method)
            values = values_of(some, COLUMNS[kind])
            if not values:
                continue
            median = statistics.median(values)
            zero = "(below" in cell["text"] and median == 0.0
            if math.isinf(median):
                cell["text"] = lost_text(kind, some)
                cell.pop("value", None)
            elif not zero:
                cell["text"], cell["value"] = number_text(median), median
            cell["spread"] = spread_text(values)
            cell.pop("live", None)
            if live := live_text(kind, some):
                cell["live"] = live
            if len({run["seed"] for run in some}) < MIN_SEEDS:
                cell.pop("bold", None)
                cell.pop("underlined", None)
    (DATA / (study + ".json")).write_text(json.dumps(tables, indent=1) + "\n")


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


def is_cell(cell, kind, runs):
    """Whether a stored cell has the median, the range and the marks that the runs allow."""
    values = values_of(runs, COLUMNS[kind])
    median = statistics.median(values) if values else None
    if median is None:
        return cell.get("value") is None
    if math.isinf(median):
        same = cell["text"] == lost_text(kind, runs)
    else:
        same = math.isclose(cell["value"], median, rel_tol=1e-6, abs_tol=1e-9)
    marked = cell.get("bold") or cell.get("underlined")
    return (same and is_spread(cell["spread"], values) and
            cell.get("live", "") == live_text(kind, runs) and
            not (marked and len({run["seed"] for run in runs}) < MIN_SEEDS))


def faults_of(study):
    """Cells of the stored tables that are not the medians of the stored runs."""
    runs = runs_of(study)
    checked = 0
    for name, stored in tables_of(study).items():
        for sensor, method, cell in cells_of(stored):
            kind, some = runs_of_cell(runs, name, sensor, method)
            checked += 1
            if not is_cell(cell, kind, some):
                median = statistics.median(values_of(some, COLUMNS[kind]) or [math.nan])
                yield f"{study}: {name}, {sensor}, {method}: {cell}, but the runs give {median}"
    if checked == 0:
        yield f"{study}: no table of it was compared with its runs"


def stored_report(study):
    return json.loads((NEEDS / (study + ".json")).read_text())


def check():
    faults = [fault for file in sorted(DATA.glob("*.csv")) for fault in faults_of(file.stem)]
    faults += [f"{file.stem}: {fault}" for file in sorted(NEEDS.glob("*.json"))
               for fault in report_tables.faults_of(stored_report(file.stem), runs_of(file.stem), judged)]
    for file in PAGES:
        page = file.read_text()
        if found := re.search(r"\S\n *<!-- (=|ratio|median|runs) [^\n]*", page):
            faults.append(f"{file.name}: a figure that starts a line ends the paragraph before it: {found[0].strip()}")
        if renewed(page) != page:
            faults.append(f"{file.name}: differs from docs/results/data, run docs/renew_results.py")
        if paper_protocol.BLOCK.search(page) and paper_protocol.renewed(page) != page:
            faults.append(f"{file.name}: differs from docs/results/data/paper, run docs/paper_protocol.py --page")
        if file.name not in ("performance.md", "machines.md"):  # they also have figures of other programs
            text = BLOCK.sub("", page)
            for other in (paper_protocol, targets):  # their tests compare them with the rows
                text = other.BLOCK.sub("", text)
            by_hand = re.findall(r"(?<![\w.])\d+\.\d+(?![\w.])", text)
            faults += [f"{file.name}: {number} was typed by hand" for number in by_hand]
    return faults


def take_over_report(study, name):
    """The tables of a report that pages show by `report`, and its runs. False: no page shows one."""
    columns = [column for page in PAGES for found in BLOCK.finditer(page.read_text())
               if found[2] == "report" and words_of(found)[0] == name for column in words_of(found)[1:]]
    if not columns:
        return False
    tables = {table_id: json.loads((study / "tables" / (table_id + ".json")).read_text())
              for table_id in report_tables.tables_of(columns)}
    NEEDS.mkdir(exist_ok=True)
    (NEEDS / (name + ".json")).write_text(json.dumps(tables, indent=1) + "\n")
    shutil.copyfile(study / "results.csv", NEEDS / (name + ".csv"))
    return True


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
    parser.add_argument("--judge", action="store_true")
    arguments = parser.parse_args()
    if arguments.judge:
        for file in sorted(DATA.glob("*.csv")):
            judge(file.stem)
    if arguments.check:
        faults = check()
        print(*faults, sep="\n")
        sys.exit(1 if faults else 0)
    if arguments.study and arguments.study.suffix == ".json":
        take_over_speed(arguments.study)
    elif arguments.study and arguments.study.suffix == ".tsv":
        shutil.copyfile(arguments.study, DATA / "costs.tsv")
    elif arguments.study and not take_over_report(arguments.study, arguments.name or arguments.study.name):
        take_over(arguments.study, arguments.name or arguments.study.name)
    for page in PAGES:
        page.write_text(renewed(page.read_text()))


if __name__ == "__main__":
    main()
