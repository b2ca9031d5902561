#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Computes what docs/results/paper_protocol.md says: the speed that one cell of the paper's table 2 fixes, and
how well all other cells are then predicted.

usage: paper_protocol.py fit         the speed, from docs/results/data/paper/speeds.csv
       paper_protocol.py NAME        one of the tables: fit, cells, scores, turns, two_speeds, findings, arms
       paper_protocol.py --page FILE renews the tables between `<!-- protocol NAME -->` and
                                     `<!-- end protocol -->` of a page

docs/results/data/paper/ has the results.csv of the studies: speeds.csv (paper_speeds), full.csv (paper_full), arms.csv
(paper_arms) and ramp.csv (paper_ramp). The paper's figures are configs/studies/paper.csv. Figures are in cm and %.
A run that did not end with status ok, or lacks a figure, counts as infinite, in medians and ranks; all others count
with their figure.
"""
import argparse
import csv
import math
import pathlib
import random
import re
import statistics
import sys

DOCS = pathlib.Path(__file__).resolve().parent
DATA = DOCS / "results" / "data" / "paper"
PAPER = DOCS.parent / "configs" / "studies" / "paper.csv"
MID, OS0, GPU = "livox_mid360_paper", "ouster_os0_128_paper", "paper_gpu_ray"
WORLDS = {"cave": "cave", "house": "house", "house_open": "house"}
SENSORS = (MID, OS0)
METHODS = ("ct_icp", "kiss_icp", "lio_sam_lc", "lio_sam", "fast_lio2")
CELLS = [(world, sensor, method) for world in ("cave", "house") for sensor in SENSORS for method in METHODS]
NAMES = {"cave": "Cave", "house": "House", MID: "Mid-360", OS0: "OS0-128", GPU: "gpu_ray",
         "ct_icp": "CT-ICP", "kiss_icp": "KISS-ICP", "lio_sam_lc": "LIO-SAM with loops",
         "lio_sam": "LIO-SAM", "fast_lio2": "FAST-LIO2"}
DRIFT, OUTLIERS, RMSE = ("rpe_1m_at_poses_translation_cm", "own_map_outliers_vertices_percent",
                         "own_map_rmse_vertices_cm")
MEMORY = "own_memory_growth_r_squared"
TABLES = {"table2": DRIFT, "table4": OUTLIERS, "table5": RMSE}
SPEED = "flight.speed"
# The cell that fixes the speed is the first of these that can.
FIT_ORDER = [(world, sensor, method) for world in ("house", "cave") for sensor in SENSORS
             for method in ("fast_lio2", "ct_icp", "kiss_icp", "lio_sam", "lio_sam_lc")]
LEAST = 1e-4  # %: one point in a million; a map without outliers counts as this
PERMUTATIONS = 10_000
# Methods of paper_arms and paper_ramp, the methods whose cells they replace, and what they are.
ARMS = {"kiss_fixed": ("kiss_icp", "KISS-ICP, cells of half a meter"),
        "kiss_from_5m": ("kiss_icp", "KISS-ICP, points from 5 m on"),
        "ct_icp_driving": ("ct_icp", "CT-ICP, profile for driving"),
        "lio_sam_release": ("lio_sam", "LIO-SAM, rules for a spinning sensor instead of the port's"),
        "lio_sam_lc_release": ("lio_sam_lc", "the same, with loops"),
        "lio_sam_shipped": ("lio_sam", "LIO-SAM, files as shipped"),
        "lio_sam_lc_shipped": ("lio_sam_lc", "the same, with loops"),
        "fast_lio2_coarse": ("fast_lio2", "FAST-LIO2, cells of half a meter"),
        "fast_lio2_shipped": ("fast_lio2", "the same, points from 4 m on"),
        "fast_lio2_azimuth": ("fast_lio2", "FAST-LIO2, times from the azimuth")}


# Figures of runs and cells.

def read_paper(file=PAPER):
    """{(figure's column, cell): the paper's value}."""
    units = {DRIFT[:-3]: DRIFT, OUTLIERS[:-8]: OUTLIERS, RMSE[:-3]: RMSE}
    with open(file, newline="") as lines:
        rows = csv.DictReader(line for line in lines if not line.startswith("#"))
        return {(units[row["figure"]], (row["world"], row["sensor"], row["algorithm"])): float(row["value"])
                for row in rows if row["figure"] in units and row["world"]}


def read_runs(name, optional=False):
    file = DATA / (name + ".csv")
    if optional and not file.exists():
        return []
    if not file.exists():
        raise SystemExit(f"{file} is missing: fly the study, and copy its results.csv there")
    with file.open(newline="") as lines:
        return list(csv.DictReader(lines))


def figure_of(run, column):
    """Infinite for a run that ended itself or has no such figure."""
    return float(run[column]) if run["status"] == "ok" and run.get(column) else math.inf


def cell_of(run):
    return WORLDS.get(run["world"], run["world"]), run["sensor"], run["algorithm"]


def values_of(runs, column):
    """{cell: the figures of its runs, by seed}."""
    values = {}
    for run in sorted(runs, key=lambda run: int(run["seed"])):
        values.setdefault(cell_of(run), []).append(figure_of(run, column))
    return values


def medians_of(runs, column):
    return {cell: statistics.median(values) for cell, values in values_of(runs, column).items()}


# The speed.

def curves_of(runs, column=DRIFT):
    """{cell: [(speed, median over the worlds), ...] by speed}."""
    curves = {}
    for speed in sorted({float(run[SPEED]) for run in runs}):
        for cell, value in medians_of([r for r in runs if float(r[SPEED]) == speed], column).items():
            curves.setdefault(cell, []).append((speed, value))
    return curves


def floored(value, column):
    return max(value, LEAST) if column == OUTLIERS else value


def at_speed(curve, speed):
    """The curve's value at a speed: straight lines in logarithms, continued beyond the ends. Infinite
    where an end of the line is."""
    pairs = list(zip(curve, curve[1:]))
    (s0, v0), (s1, v1) = next((pair for pair in pairs if speed <= pair[1][0]), pairs[-1])
    if speed in (s0, s1):
        return v0 if speed == s0 else v1
    if not (math.isfinite(v0) and math.isfinite(v1)):
        return math.inf
    share = math.log(speed / s0) / math.log(s1 / s0)
    return v0 * (v1 / v0) ** share


def fitted_speed(curve, value):
    """(speed at which the curve has the value, "") or (None, why the curve cannot fix a speed)."""
    values = [v for _, v in curve]
    if not all(map(math.isfinite, values)):
        return None, "a run ended itself"
    if any(a >= b for a, b in zip(values, values[1:])):
        return None, "not monotonic"
    if not values[0] <= value <= values[-1]:
        return None, "does not bracket"
    for (s0, v0), (s1, v1) in zip(curve, curve[1:]):
        if value <= v1:
            return s0 * (s1 / s0) ** (math.log(value / v0) / math.log(v1 / v0)), ""
    raise AssertionError("bracketed")


def fit(curves, paper, order=FIT_ORDER):
    """(cell, speed) of the first cell of `order` that fixes a speed."""
    for cell in order:
        if cell in curves and (DRIFT, cell) in paper:
            speed, _ = fitted_speed(curves[cell], paper[DRIFT, cell])
            if speed is not None:
                return cell, speed
    raise SystemExit("no cell is monotonic in the speed and brackets the paper's value")


# Scores: ours and the paper's values of the same cells.

def ranks_of(values):
    """Ranks from 1, the mean rank for equal values."""
    order = sorted(range(len(values)), key=values.__getitem__)
    ranks = [0.0] * len(values)
    first = 0
    while first < len(order):
        last = first
        while last + 1 < len(order) and values[order[last + 1]] == values[order[first]]:
            last += 1
        for i in order[first:last + 1]:
            ranks[i] = 0.5 * (first + last) + 1.0
        first = last + 1
    return ranks


def correlation(a, b):
    """Pearson's; 0 where one does not vary."""
    mean_a, mean_b = statistics.fmean(a), statistics.fmean(b)
    product = sum((x - mean_a) * (y - mean_b) for x, y in zip(a, b))
    size = math.sqrt(sum((x - mean_a) ** 2 for x in a) * sum((y - mean_b) ** 2 for y in b))
    return product / size if size > 0.0 else 0.0


def rank_correlation(ours, paper):
    """Spearman's."""
    return correlation(ranks_of(ours), ranks_of(paper))


def median_factor(ours, paper):
    """exp of the median of |log(ours / paper)|: 1 is perfect."""
    return math.exp(statistics.median(abs(math.log(a / b)) if math.isfinite(a) else math.inf
                                      for a, b in zip(ours, paper)))


def share_within(ours, paper, factor):
    near = sum(1 / factor <= a / b <= factor for a, b in zip(ours, paper))
    return f"{near} of {len(ours)}"


def chance(ours, paper, groups, permutations=PERMUTATIONS, seed=1):
    """The share of permutations of our values within the groups whose rank correlation is at least as high as
    ours, which counts as one of them."""
    r = random.Random(seed)
    ours_ranks, paper_ranks = ranks_of(ours), ranks_of(paper)
    places = {}
    for i, group in enumerate(groups):
        places.setdefault(group, []).append(i)
    found = correlation(ours_ranks, paper_ranks) - 1e-12
    reached = 1
    for _ in range(permutations):
        moved = list(ours_ranks)
        for group in places.values():
            shuffled = r.sample(group, len(group))
            for to, source in zip(group, shuffled):
                moved[to] = ours_ranks[source]
        reached += correlation(moved, paper_ranks) >= found
    return reached / (permutations + 1)


def mean_of(paper, column, cell, by_method):
    """The geometric mean of the paper's table over the cell's column (its method), or over its row (its world and
    sensor). It includes the cell itself, in the predictor's favor."""
    alike = [value for (figure, other), value in paper.items() if figure == column and
             (other[2] == cell[2] if by_method else other[:2] == cell[:2])]
    return math.exp(statistics.fmean(map(math.log, alike)))


def compare(ours, paper, column, left_out=()):
    """The cells that both have, but those left out, with the values of both."""
    cells = [c for c in CELLS if c in ours and (column, c) in paper and c not in left_out]
    return cells, [floored(ours[c], column) for c in cells], [paper[column, c] for c in cells]


# Tables, as lists of rows of text; the first is the head.

def text(value):
    if value is None:
        return "-"
    if math.isinf(value):
        return "ended"
    return f"{value:.3g}" if value >= 1e-3 or value == 0.0 else f"{value:.2e}"


def name(cell):
    return f"{NAMES[cell[0]]}, {NAMES[cell[1]]}: {NAMES[cell[2]]}"


def table_fit(paper, speeds):
    curves = curves_of(speeds)
    chosen, _ = fit(curves, paper)
    columns = [speed for speed, _ in next(iter(curves.values()))]
    rows = [["cell", "paper", *[f"speed {s:g}" for s in columns], "fitted speed"]]
    for cell in CELLS:
        if cell in curves:
            speed, why = fitted_speed(curves[cell], paper[DRIFT, cell])
            shown = why if speed is None else f"**{speed:.3f}**" if cell == chosen else f"{speed:.3f}"
            rows.append([name(cell), f"{paper[DRIFT, cell]:g}", *[text(v) for _, v in curves[cell]], shown])
    return rows


def table_cells(paper, full):
    """Each cell of the three tables: the paper's value, and our median with the range of the runs that ended well."""
    rows = [["cell", *[head for table in TABLES for head in (f"table {table[5:]}, paper", "anew")], "runs that ended well"]]
    values = {column: values_of(full, column) for column in TABLES.values()}
    for cell in CELLS:
        if cell in values[DRIFT]:
            row = [name(cell)]
            for column in TABLES.values():
                some = values[column][cell]
                kept = [value for value in some if math.isfinite(value)]
                spread = f" ({text(min(kept))} to {text(max(kept))})" if kept else ""
                row += [f"{paper[column, cell]:g}", text(statistics.median(some)) + spread]
            kept = [value for value in values[DRIFT][cell] if math.isfinite(value)]
            rows.append([*row, f"{len(kept)} of {len(values[DRIFT][cell])}"])
    return rows


def table_scores(paper, full, fitted):
    rows = [["table", "predictor", "cells", "rank correlation", "median factor", "within 2", "within 3",
             "chance", "chance within rows", "chance within columns", "verdict"]]
    for table, column in TABLES.items():
        cells, ours, theirs = compare(medians_of(full, column), paper, column,
                                      (fitted,) if column == DRIFT else ())
        predictors = {"ours": ours,
                      "the paper's row mean": [mean_of(paper, column, c, False) for c in cells],
                      "the paper's column mean": [mean_of(paper, column, c, True) for c in cells]}
        scores = {which: (rank_correlation(values, theirs), median_factor(values, theirs))
                  for which, values in predictors.items()}
        for predictor, values in predictors.items():
            judged = [""] * 4
            if predictor == "ours":
                chances = [chance(values, theirs, groups) for groups in
                           ([0] * len(cells), [c[:2] for c in cells], [c[2] for c in cells])]
                judged = [*[f"{p:.4f}" for p in chances], verdict_of_table(scores, chances[0])]
            rank, factor = scores[predictor]
            rows.append([table[5:], predictor, str(len(cells)), f"{rank:.2f}", f"{factor:.2f}",
                         share_within(values, theirs, 2), share_within(values, theirs, 3), *judged])
    return rows


def verdict_of_table(scores, chance_of_rank):
    """The protocol's rule of success. `scores`: {predictor: (rank correlation, median factor)}, with ours."""
    others = [pair for which, pair in scores.items() if which != "ours"]
    rank, factor = scores["ours"]
    failed = [what for what, holds in (("rank correlation", all(rank > r for r, _ in others)),
                                       ("median factor", all(factor < f for _, f in others)),
                                       ("chance", chance_of_rank < 0.01)) if not holds]
    return "fails by " + " and ".join(failed) if failed else "succeeds"


def predicted(curves, speed_of):
    """Each cell's value at the speed of its world."""
    return {cell: at_speed(curve, speed_of[cell[0]]) for cell, curve in curves.items()}


def table_turns(paper, speeds):
    """Each cell that can fixes the speed in its turn; the others are read from the curves."""
    curves = curves_of(speeds)
    rows = [["fitted cell", "speed", "cells", "rank correlation", "median factor"]]
    for cell in CELLS:
        if cell not in curves:
            continue
        speed, _ = fitted_speed(curves[cell], paper[DRIFT, cell])
        if speed is not None:
            ours = predicted(curves, {"cave": speed, "house": speed})
            cells, values, theirs = compare(ours, paper, DRIFT, (cell,))
            rows.append([name(cell), f"{speed:.3f}", str(len(cells)),
                         f"{rank_correlation(values, theirs):.2f}", f"{median_factor(values, theirs):.2f}"])
    return rows


def table_two_speeds(paper, speeds):
    """One free number, or one for each world."""
    curves = curves_of(speeds)
    one, speed = fit(curves, paper)
    rows = [["free numbers", "speed in the Cave", "speed in the House", "cells", "rank correlation",
             "median factor"]]
    choices = [("1", {"cave": speed, "house": speed}, (one,))]
    try:
        fits = {world: fit(curves, paper, [c for c in FIT_ORDER if c[0] == world]) for world in ("cave", "house")}
        choices.append(("2", {w: s for w, (_, s) in fits.items()}, tuple(c for c, _ in fits.values())))
    except SystemExit:
        rows.append(["2", "no cell of one of the worlds can fix it", "", "", "", ""])
    for count, speed_of, left_out in choices:
        cells, values, theirs = compare(predicted(curves, speed_of), paper, DRIFT, left_out)
        rows.insert(int(count), [count, f"{speed_of['cave']:.3f}", f"{speed_of['house']:.3f}", str(len(cells)),
                                 f"{rank_correlation(values, theirs):.2f}",
                                 f"{median_factor(values, theirs):.2f}"])
    return rows


# The twelve findings of configs/studies/paper.yaml, for one Cave and one House.

class Unknown(Exception):
    """A figure is missing, or a ratio has two infinite ends."""


def ratio(a, b):
    if math.isinf(a) and math.isinf(b):
        raise Unknown
    return math.inf if b == 0.0 else a / b


def is_extreme(value, world, sensor, method, sign):
    own = sign * value(DRIFT, world, sensor, method)
    return all(own < sign * value(DRIFT, world, sensor, other) for other in METHODS if other != method)


def each(test, worlds=("cave", "house"), sensors=SENSORS):
    return all(test(world, sensor) for world in worlds for sensor in sensors)


FINDINGS = {
    "FAST-LIO2 has the lowest drift on both maps and with both sensors":
        lambda v: each(lambda w, s: is_extreme(v, w, s, "fast_lio2", 1)),
    "KISS-ICP has the highest drift":
        lambda v: each(lambda w, s: is_extreme(v, w, s, "kiss_icp", -1)),
    "CT-ICP's drift hardly depends on the sensor":
        lambda v: all(0.8 < ratio(v(DRIFT, w, MID, "ct_icp"), v(DRIFT, w, OS0, "ct_icp")) < 1.25
                      for w in ("cave", "house")),
    "CT-ICP's Cave map has ten times the outliers with the Mid-360":
        lambda v: ratio(v(OUTLIERS, "cave", MID, "ct_icp"), v(OUTLIERS, "cave", OS0, "ct_icp")) > 5,
    "KISS-ICP's Cave map is worse with the OS0-128":
        lambda v: ratio(v(OUTLIERS, "cave", OS0, "kiss_icp"), v(OUTLIERS, "cave", MID, "kiss_icp")) > 1,
    "LIO-SAM drifts less with the dense sensor in the Cave":
        lambda v: ratio(v(DRIFT, "cave", MID, "lio_sam"), v(DRIFT, "cave", OS0, "lio_sam")) > 1,
    "LIO-SAM drifts less with the dense sensor in the House":
        lambda v: ratio(v(DRIFT, "house", MID, "lio_sam"), v(DRIFT, "house", OS0, "lio_sam")) > 1,
    "Loop closure improves the Cave map":
        lambda v: all(ratio(v(OUTLIERS, "cave", s, "lio_sam_lc"), v(OUTLIERS, "cave", s, "lio_sam")) < 0.5
                      for s in SENSORS),
    "Loop closure worsens the House map with the Mid-360":
        lambda v: ratio(v(OUTLIERS, "house", MID, "lio_sam_lc"), v(OUTLIERS, "house", MID, "lio_sam")) > 1,
    "The House is easy for all algorithms":
        lambda v: all(v(OUTLIERS, "house", s, m) < 5 for s in SENSORS for m in METHODS),
    "From Cave to House the drift grows less for LIO-SAM than for FAST-LIO2":
        lambda v: all(ratio(v(DRIFT, "house", s, "lio_sam"), v(DRIFT, "cave", s, "lio_sam")) <
                      ratio(v(DRIFT, "house", s, "fast_lio2"), v(DRIFT, "cave", s, "fast_lio2"))
                      for s in SENSORS),
    "FAST-LIO2's memory grows linearly with time, in proportion to the points":
        lambda v: each(lambda w, s: 0.9 < v(MEMORY, w, s, "fast_lio2") < math.inf),
}


def judge(finding, figures):
    """True, False, or None where it cannot be judged. `figures`: {(column, cell): value}."""
    def value(column, *cell):
        if (column, cell) not in figures:
            raise Unknown
        found = figures[column, cell]
        return floored(found, column) if math.isfinite(found) else found
    try:
        return FINDINGS[finding](value)
    except Unknown:
        return None


def figures_of(runs):
    return {(column, cell_of(run)): figure_of(run, column)
            for run in runs for column in (DRIFT, OUTLIERS, RMSE, MEMORY)}


def judged_in(finding, runs, seeds, replaced=()):
    """Answers for each seed's pair of worlds, with some runs in place of those of the same cells."""
    return [judge(finding, figures_of([r for r in runs if r["seed"] == seed]) |
                  figures_of([r for r in replaced if r["seed"] == seed])) for seed in seeds]


def verdict_of(judged, arms, saving):
    """The protocol's word on a finding: `judged` in each pair of worlds, `saving` the arms with which it holds."""
    most = 0.9 * len(judged)
    if judged.count(True) >= most:
        return "confirmed"
    if judged.count(False) < most:
        return "depends on the world"
    if not arms:
        return "fails; the arms are not flown"
    return "fails, but for an arm" if saving else "contradicted"


def table_findings(full, arms, ramp):
    """In how many pairs of worlds each holds, the arms with which it holds in most of theirs, and the verdict."""
    seeds = sorted({run["seed"] for run in full}, key=int)
    few = sorted({run["seed"] for run in arms + ramp}, key=int)
    flown = arm_runs(arms, ramp)
    rows = [["finding", "verdict", "holds", "does not", "cannot be judged",
             "holds with the base arm in the worlds of the arms", "arms with which it holds in most of them"]]
    for finding in FINDINGS:
        judged = judged_in(finding, full, seeds)
        found = [label for label, runs in flown.items()
                 if 2 * judged_in(finding, full, few, runs).count(True) > len(few)]
        rows.append([finding, verdict_of(judged, flown, found),
                     *[f"{judged.count(answer)} of {len(seeds)}" for answer in (True, False, None)],
                     f"{judged_in(finding, full, few).count(True)} of {len(few)}" if few else "-",
                     f"all {len(found)}" if found and len(found) == len(flown) else "; ".join(found) or "none"])
    return rows


# Arms: the base arm with some cells replaced, in the worlds of the arms.

def arm_runs(arms, ramp):
    """{what the arm is: its runs, with the names of the cells that they replace}."""
    found = {}
    for run in arms:
        if run["sensor"] == GPU and run["algorithm"] in METHODS:
            found.setdefault("gpu_ray instead of the OS0-128", []).append(run | {"sensor": OS0})
        elif run["algorithm"] in ARMS:
            method, label = ARMS[run["algorithm"]]
            if method == "lio_sam_lc":
                label = ARMS[run["algorithm"].replace("_lc", "")][1]
            found.setdefault(label, []).append(run | {"algorithm": method})
    for run in ramp:
        label = f"times of a ramp of {1e3 * float(run['sensor.ramp_s']):.0f} ms"
        found.setdefault(label, []).append(run)
    return found


def table_arms(paper, full, arms, ramp, fitted):
    seeds = {run["seed"] for run in arms + ramp}
    base = medians_of([run for run in full if run["seed"] in seeds], DRIFT)
    rows = [["arm", "cells replaced", "rank correlation", "median factor", "cell: base, arm (paper)"]]

    if not seeds:
        raise SystemExit(f"no arm is flown: {DATA} has neither arms.csv nor ramp.csv")

    def row(label, replaced):
        cells, values, theirs = compare(base | replaced, paper, DRIFT, (fitted,))
        shown = "; ".join(f"{name(c)} {text(base.get(c))}, {text(replaced[c])} ({paper[DRIFT, c]:g})"
                          for c in CELLS if c in replaced)
        rows.append([label, str(len(replaced)), f"{rank_correlation(values, theirs):.2f}",
                     f"{median_factor(values, theirs):.2f}", shown])
    row("base", {})
    for label, runs in arm_runs(arms, ramp).items():
        row(label, medians_of(runs, DRIFT))
    return rows


def markdown(rows):
    lines = ["| " + " | ".join(row) + " |" for row in rows]
    return "\n".join([lines[0], "|---|" + "---:|" * (len(rows[0]) - 1), *lines[1:]])


def block(what):
    """The table of this name, as Markdown."""
    paper = read_paper()
    fitted = lambda: fit(curves_of(read_runs("speeds")), paper)[0]
    makers = {"fit": lambda: table_fit(paper, read_runs("speeds")),
              "cells": lambda: table_cells(paper, read_runs("full")),
              "scores": lambda: table_scores(paper, read_runs("full"), fitted()),
              "turns": lambda: table_turns(paper, read_runs("speeds")),
              "two_speeds": lambda: table_two_speeds(paper, read_runs("speeds")),
              "findings": lambda: table_findings(read_runs("full"), read_runs("arms", True), read_runs("ramp", True)),
              "arms": lambda: table_arms(paper, read_runs("full"), read_runs("arms", True), read_runs("ramp", True),
                                         fitted())}
    if what not in makers:
        raise SystemExit(f"there is no table '{what}'; there are {', '.join(makers)}")
    return markdown(makers[what]())


BLOCK = re.compile(r"(<!-- protocol (\w+) -->\n)(.*?)(<!-- end protocol -->)", re.DOTALL)


def renewed(page):
    return BLOCK.sub(lambda found: f"{found[1]}\n{block(found[2])}\n\n{found[4]}", page)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("table", nargs="?")
    parser.add_argument("--page", type=pathlib.Path)
    arguments = parser.parse_args()
    if arguments.page:
        arguments.page.write_text(renewed(arguments.page.read_text()))
    elif arguments.table == "fit":
        cell, speed = fit(curves_of(read_runs("speeds")), read_paper())
        print(block("fit"))
        print(f"speed {speed:.3f}, by {name(cell)}")
    elif arguments.table:
        print(block(arguments.table))
    else:
        parser.print_usage()
        sys.exit(2)


if __name__ == "__main__":
    main()
