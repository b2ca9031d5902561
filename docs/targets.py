#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Judges our methods against the targets that were set for them.

usage: targets.py [development|drone|test|test_drone] each target: met or missed
       targets.py --page FILE        renews the blocks of a page: <!-- targets SET -->, and tables of the development
                                     set, <!-- kinds -->, <!-- harsh -->, <!-- real_imu --> and <!-- errors -->, and
                                     of the test set, <!-- real_imu test -->; --check instead of writing it

The rows are kinds.csv, harsh.csv, real_imu.csv and errors_arena_lio.csv in docs/history/development_set/data, and test.csv,
test_kinds.csv, test_harsh.csv and test_real_imu.csv in docs/results/data. Ratios are of medians over the seeds, but where a flight is named. A lost run counts as infinite.
"""
import csv
import itertools
import math
import pathlib
import re
import statistics
import sys

DOCS = pathlib.Path(__file__).resolve().parent
DATA = DOCS / "history" / "development_set" / "data"
TEST = DOCS / "results" / "data"
SETS = {"development": [DATA / "kinds.csv", DATA / "harsh.csv"],
        "drone": [DATA / "real_imu.csv"],
        "test": [TEST / (name + ".csv") for name in ("test", "test_kinds", "test_harsh")],
        "test_drone": [TEST / "test_real_imu.csv"]}
FINAL, LIVE, CLOCK = "rpe_1m_at_poses_translation_cm", "live_rpe_1m_at_poses_translation_cm", "rpe_1m_at_lidar_clock_cm"
CPU = "cpu_load_percent"  # at ten scans a second also milliseconds a scan
LOST_CM = 100.0
WORLDS = {"test_house": "House", "test_cave": "Cave", "dev_mine": "mine", "dev_forest": "forest", "dev_hall": "hall",
          "dev_office": "office"}
SENSORS = {"livox_mid360": "Mid-360", "ouster_os0_128": "OS0-128",
           "mid360_recorded_imu": "Mid-360", "os0_recorded_imu": "OS0-128"}
DRONE = {"v101": "V101", "v103": "V103", "v203": "V203", "mh03": "MH03", "mh05": "MH05"}  # recorded flights; of others there is one in each world


def read(*files):
    rows = []
    for path in files:
        if not path.exists():
            raise SystemExit(f"{path}: no rows: fly the study and take over its results.csv first")
        with path.open(newline="") as file:
            rows += csv.DictReader(file)
    return rows


def is_lost(row):
    return row["status"] != "ok" or float(row[FINAL]) > LOST_CM


def value(row, column):
    return math.inf if is_lost(row) or not row[column] else float(row[column])


def cell_of(row):
    """(world, recorded flight or nothing, sensor)"""
    return row["world"], row["flight"] if row["flight"] in DRONE else "", row["sensor"]


def method_of(row):
    return row["algorithm"] + (":" + row["preset"] if row["preset"] else "")


class Runs:
    """Figures by cell and method; `method:preset` for a published one."""

    def __init__(self, rows):
        self.rows = rows

    def of(self, method, column, cell=None):
        """{(*cell, seed): figure}"""
        return {(*cell_of(r), r["seed"]): value(r, column) for r in self.rows
                if method_of(r) == method and cell in (None, cell_of(r))}

    def median(self, method, column, cell):
        return statistics.median(self.of(method, column, cell).values())

    def cells(self):
        """Those with a known sensor, in the order of WORLDS."""
        found = {cell_of(r) for r in self.rows}
        return [c for c in itertools.product(WORLDS, ("", *DRONE), SENSORS) if c in found]


def named(cell):
    world, flight, sensor = cell
    return ", ".join(word for word in (DRONE.get(flight), WORLDS[world], SENSORS.get(sensor, sensor)) if word)


def spread(ratios):
    """Text of the smallest and the largest, {cell: ratio}."""
    low, high = min(ratios, key=ratios.get), max(ratios, key=ratios.get)
    return f"{ratios[low]:.2f} ({named(low)}) to {ratios[high]:.2f} ({named(high)})"


def limited(ratios, limit):
    """(whether all are below the limit, text)"""
    missed = [f"{named(cell)} {ratio:.2f}" for cell, ratio in ratios.items() if not ratio <= limit]
    return not missed, spread(ratios) + (f"; above: {', '.join(missed)}" if missed else "")


def lost_runs(runs, method):
    figures = runs.of(method, FINAL)
    lost = [f"{named(cell)}, {seed}" for (*cell, seed), v in figures.items() if math.isinf(v)]
    return len(lost), len(figures), "; ".join(lost)


def judged(ideal, harsh, with_cpu):
    """[(target, met, text)]"""
    cells = ideal.cells()
    ratio = lambda a, b, of=FINAL: {c: ideal.median(a, of, c) / ideal.median(b, of, c) for c in cells}
    rows = []
    for method, share in (("arena_lio", 0.0), ("arena_lo", 0.05)):
        lost, flown, which = lost_runs(Runs(ideal.rows + harsh.rows), method)
        rows.append((f"`{method}` loses no flight" if share == 0.0 else f"`{method}` loses at most one flight in twenty",
                     lost <= share * flown, f"{lost} of {flown}" + (f" ({which})" if which else "")))
    live = {c: ideal.median("arena_lio", LIVE, c) / ideal.median("arena_lio", FINAL, c) for c in cells}
    rows.append(("`arena_lio` live at most 1.3 times final", *limited(live, 1.3)))
    for rival in sorted({method_of(r) for r in ideal.rows if r["algorithm"] == "fast_lio2"}, reverse=True):
        name = f"`{rival.partition(':')[2]}` FAST-LIO2"
        final = ratio("arena_lio", rival)
        rows.append((f"final at most half of {name}", *limited(final, 0.5)))
        two = {c: r for c, r in final.items() if c[0] in ("test_house", "test_cave")}
        rows.append(("in House and Cave at most a third", *limited(two, 1 / 3)))
        rows.append(("live ahead of it in each cell", *limited(ratio("arena_lio", rival, LIVE), 1.0)))
        flights = {}
        of_rival = ideal.of(rival, FINAL)
        for flight, own in ideal.of("arena_lio", FINAL).items():
            cell = flight[:-1]
            if cell in cells:
                flights[cell] = max(flights.get(cell, 0.0), own / of_rival[flight])
        rows.append(("no flight more than a tenth worse than it; the worst flight of each cell", *limited(flights, 1.1)))
    rows.append(("an IMU never makes it worse than `arena_lo`", *limited(ratio("arena_lio", "arena_lo"), 1.0)))
    for column, what in ((FINAL, "at true time"), (CLOCK, "at the LiDAR's clock")) if harsh.rows else ():
        grown = {(w, f, s): harsh.median("arena_lio", column, (w, f, s + "_harsh")) / ideal.median("arena_lio", FINAL, (w, f, s))
                 for w, f, s in cells if w in ("test_house", "test_cave")}
        rows.append((f"all errors at most three times ideal, {what}", *limited(grown, 3.0)))
    if with_cpu:
        for method, limits in (("arena_lio", (6.0, 12.0)), ("arena_lo", (10.0, 20.0))):
            for sensor, limit in zip(SENSORS, limits):
                load = {c: ideal.median(method, CPU, c) for c in cells if c[2] == sensor}
                rows.append((f"CPU of `{method}` at most {limit:g} ms a scan, {SENSORS[sensor]}", *limited(load, limit)))
    return rows


def table(of="development"):
    rows = read(*SETS[of])
    ideal, harsh = (Runs([r for r in rows if r["sensor"].endswith("_harsh") == is_harsh]) for is_harsh in (False, True))
    lines = ["| target | | medians over seeds |", "|---|---|---|"]
    for target, met, text in judged(ideal, harsh, with_cpu=of == "test"):
        lines.append(f"| {target} | {'met' if met else '**missed**'} | {text} |")
    return "\n".join(lines)


def cell(rows):
    """Text of the drift of some runs: median final / live; at the LiDAR's clock (range of the final one)."""
    finals = [value(r, FINAL) for r in rows]
    median = lambda column: f"{statistics.median(value(r, column) for r in rows):.3g}"
    clock = f"; {median(CLOCK)}" if all(r.get(CLOCK) for r in rows) else ""
    return f"{median(FINAL)} / {median(LIVE)}{clock} ({min(finals):.3g} to {max(finals):.3g})"


def drift(file):
    rows = read(file)
    methods = {"arena_lio": "`arena_lio`", "arena_lo": "`arena_lo`", "fast_lio2:tuned": "FAST-LIO2 `tuned`",
               "fast_lio2:indoor": "`indoor`", "ct_icp:tuned": "CT-ICP"}
    methods = {m: title for m, title in methods.items() if m in map(method_of, rows)}
    lines = [f"| world, sensor | {' | '.join(methods.values())} | seeds |", "|---" * (len(methods) + 2) + "|"]
    order = lambda c: (list(WORLDS).index(c[0]), list(DRONE).index(c[1]) if c[1] else -1, c[2])
    for found in sorted({cell_of(r) for r in rows}, key=order):
        of = [[r for r in rows if (cell_of(r), method_of(r)) == (found, m)] for m in methods]
        title = "the same, harsh" if found[2].endswith("_harsh") else named(found)
        lines.append(f"| {title} | {' | '.join(map(cell, of))} | {len(of[0])} |")
    return "\n".join(lines)


def error_shares():
    """The drift of `arena_lio` with each group of errors alone, as cell()."""
    rows = read(DATA / "errors_arena_lio.csv")
    lines = ["| variation | House | Cave |", "|---|---|---|"]
    for name in dict.fromkeys(r["variation"] for r in rows):
        cells = (cell([r for r in rows if (r["variation"], r["world"]) == (name, world)]) for world in ("test_house", "test_cave"))
        lines.append(f"| {name or 'none'} | {' | '.join(cells)} |")
    return "\n".join(lines)


BLOCK = re.compile(r"(<!-- (targets|kinds|harsh|real_imu|errors)(?: (development|drone|test|test_drone))? -->\n).*?(<!-- end -->)", re.DOTALL)


def renewed_block(found):
    file = TEST / f"test_{found[2]}.csv" if found[3] == "test" else DATA / f"{found[2]}.csv"
    content = {"targets": lambda: table(found[3]), "errors": error_shares}.get(found[2], lambda: drift(file))()
    return f"{found[1]}\n{content}\n\n{found[4]}"


def main():
    if len(sys.argv) == 1 or sys.argv[1] in SETS:
        print(table(*sys.argv[1:]))
        return
    if len(sys.argv) != 3 or sys.argv[1] not in ("--page", "--check"):
        raise SystemExit(__doc__)
    page = pathlib.Path(sys.argv[2])
    text = page.read_text()
    renewed = BLOCK.sub(renewed_block, text)
    if sys.argv[1] == "--page":
        page.write_text(renewed)
    elif renewed != text:
        raise SystemExit(f"{page}: a block is not that of the rows: docs/targets.py --page {page}")


if __name__ == "__main__":
    main()
