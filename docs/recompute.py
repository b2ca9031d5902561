#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Computes figures of the results pages once more. It shares no code with the rest of the project, so that an error there
does not hide itself.

usage: recompute.py            figures of docs/results, from the rows in docs/results/data; fails if one differs
       recompute.py STUDY      the drift per meter of every run in a study's folder, from its two trajectories (needs numpy)
"""
import csv
import itertools
import json
import math
import pathlib
import re
import statistics
import sys

RESULTS = pathlib.Path(__file__).resolve().parent / "results"
MID, OS0, MID_PAPER, OS0_PAPER = "livox_mid360", "ouster_os0_128", "livox_mid360_paper", "ouster_os0_128_paper"
DRIFT, LIVE = "rpe_1m_at_poses_translation_cm", "live_rpe_1m_at_poses_translation_cm"


def rows(name, **wanted):
    """Rows of a CSV file, by seed."""
    with (RESULTS / "data" / f"{name}.csv").open(newline="") as file:
        return sorted((row for row in csv.DictReader(file) if all(row[k] == v for k, v in wanted.items())),
                      key=lambda row: int(row["seed"]))


def lost(row):
    if row["status"] != "ok":
        return True
    return any(float(row[c]) > limit for c, limit in ((DRIFT, 100.0), ("rpe_1m_at_poses_rotation_deg", 20.0)) if row[c])


def figures(found, column):
    return [math.inf if lost(row) else float(row[column]) for row in found]


def cell(page, before, line, column):
    """The text of a table's cell: the first table after the text `before`, the row that begins with `line`."""
    text = (RESULTS / page).read_text()
    lines = text[text.index(before):].splitlines()
    row = next(x for x in lines if x.startswith(f"| {line} |"))
    return row.strip("| ").split(" | ")[column]


def first_number(text):
    return float(re.search(r"[-+]?\d+\.?\d*(?:e-?\d+)?", text)[0])


def same(shown, value):
    """Whether a text shows the value with at least two digits."""
    return math.isclose(first_number(shown), value, rel_tol=0.006)


# The figures: each returns (what the page shows, what the rows give, whether they agree).

def drift():
    values = figures(rows("test", world="test_cave", sensor=MID, algorithm="arena_lio"), DRIFT)
    shown = cell("which_slam.md", "## Drift", "`arena_lio`", 1)
    kept = sum(map(math.isfinite, values))
    ends = re.search(r"\(([\d.]+) to ([\d.]+), (\d+) of (\d+)\)", shown)
    return shown, values, same(shown, statistics.median(values)) and same(ends[1], min(values)) and \
        same(ends[2], max(values)) and (int(ends[3]), int(ends[4])) == (kept, len(values))


def live_drift():
    values = figures(rows("test", world="test_house", sensor=OS0, algorithm="arena_lo"), LIVE)
    shown = cell("which_slam.md", "## Drift", "`arena_lo`", 4)
    return shown, values, same(shown.split(" / ")[1], statistics.median(values))


def lost_runs():
    values = figures(rows("test", world="test_house", sensor=OS0, algorithm="kiss_icp"), DRIFT)
    shown = cell("which_slam.md", "## Drift", "KISS-ICP", 4)
    return shown, values, same(shown, statistics.median(values)) and \
        f"to lost, {sum(map(math.isfinite, values))} of {len(values)})" in shown


def ended():
    found = rows("test_published", world="test_house", sensor=MID, algorithm="ct_icp", preset="published")
    times, drifts = ([float(row[column]) for row in found if row[column]] for column in ("ended_at_s", DRIFT))
    shown = cell("settings.md", "<!-- table test_published drift,map published -->", "CT-ICP", 3).split("; ")[0]
    parts = re.fullmatch(r"ended at (.*) s \[(.*)\] \(0 of (\d+)\)", shown)
    return shown, (times, drifts), parts[1] == f"{statistics.median(times):.1f}" and same(parts[2], statistics.median(drifts)) and \
        int(parts[3]) == len(found) == sum(map(lost, found))


def map_error():
    values = figures(rows("test", world="test_cave", sensor=OS0, algorithm="arena_lio+loop"), "own_map_rmse_cm")
    shown = cell("which_slam.md", "## Maps", "`arena_lio+loop`", 2)
    return shown, values, same(shown, statistics.median(values))


def outliers():
    values = figures(rows("test", world="test_cave", sensor=MID, algorithm="fast_lio2"), "own_map_outliers_percent")
    shown = cell("which_slam.md", "Points of the own map beyond 20 cm", "FAST-LIO2", 1)
    return shown, values, same(shown, statistics.median(values)) and same(shown.split(" to ")[1], max(values))


def hodges_lehmann():
    """Median of the means of all pairs of log ratios. The interval leaves out as many of them at each end as the signed rank
    test at 95 % allows; its distribution is counted over all signs."""
    sums = [[float(row[LIVE]) for row in rows("test", world="test_house", sensor=MID, algorithm=method)]
            for method in ("arena_lio", "fast_lio2")]
    logs = [math.log(b / a) for a, b in zip(*sums)]
    means = sorted((logs[i] + logs[j]) / 2 for i in range(len(logs)) for j in range(i, len(logs)))
    ranks = range(1, len(logs) + 1)
    counts = sorted(sum(itertools.compress(ranks, signs)) for signs in itertools.product((0, 1), repeat=len(logs)))
    left_out = max(w for w in range(len(means)) if sum(c <= w for c in counts) <= 0.025 * len(counts))
    values = [math.exp(v) for v in (statistics.median(means), means[left_out], means[-1 - left_out])]
    shown = cell("which_slam.md", "## Ratios", "`test` | House, Mid-360", 4)
    return shown, values, [float(x) for x in re.findall(r"[\d.]+", shown)] == [float(f"{v:.2g}") for v in values]


def of_speeds(world, sensor, method):
    """The median drift over the worlds at each speed."""
    houses = ("house", "house_open") if world == "house" else (world,)
    found = [row for row in rows("paper/speeds", sensor=sensor, algorithm=method) if row["world"] in houses]
    return {speed: statistics.median([float(row[DRIFT] or "inf") if row["status"] == "ok" else math.inf
                                      for row in found if row["flight.speed"] == speed])
            for speed in sorted({row["flight.speed"] for row in found}, key=float)}


def fitted_speed():
    medians = of_speeds("cave", MID_PAPER, "ct_icp")
    (a, low), (b, high) = list(medians.items())[-2:]
    share = (math.log(1.78) - math.log(low)) / (math.log(high) - math.log(low))
    value = math.exp(math.log(float(a)) + share * (math.log(float(b)) - math.log(float(a))))
    shown = cell("paper_protocol.md", "<!-- protocol fit -->", "Cave, Mid-360: CT-ICP", 5)
    return shown, value, shown == f"**{value:.3f}**"


def papers(figure):
    lines = (RESULTS.parents[1] / "configs" / "studies" / "paper.csv").read_text().splitlines()
    return {(row["world"], row["sensor"], row["algorithm"]): float(row["value"])
            for row in csv.DictReader(x for x in lines if not x.startswith("#"))
            if row["figure"] == figure and row["world"]}


def of_worlds(column):
    cells = {}
    for row in rows("paper/full"):
        key = ("house" if row["world"] == "house_open" else row["world"], row["sensor"], row["algorithm"])
        cells.setdefault(key, []).append(float(row[column]) if row["status"] == "ok" and row[column] else math.inf)
    return {key: statistics.median(values) for key, values in cells.items()}


def rank_correlation():
    """Of table 4, without Pearson's formula: one minus the squared differences of ranks fails with equal values, so ranks
    are compared pair by pair."""
    ours, theirs = of_worlds("own_map_outliers_vertices_percent"), papers("own_map_outliers_vertices")
    keys = sorted(set(ours) & set(theirs))

    def signs(values):
        return [[(values[b] < values[a]) - (values[b] > values[a]) for b in keys] for a in keys]
    at_least = {key: max(ours[key], 1e-4) for key in keys}
    # A rank less the mean rank is half the sum of a row of signs.
    a, b = ([sum(row) / 2 for row in signs(values)] for values in (at_least, theirs))
    value = sum(x * y for x, y in zip(a, b)) / math.sqrt(sum(x * x for x in a) * sum(y * y for y in b))
    shown = cell("paper.md", "<!-- protocol scores -->", "4 | ours", 3)
    return shown, value, shown == f"{value:.2f}"


def median_factor():
    ours, theirs = of_worlds("own_map_rmse_vertices_cm"), papers("own_map_rmse_vertices")
    value = statistics.median(max(ours[key] / theirs[key], theirs[key] / ours[key] if ours[key] < math.inf else 0.0)
                              for key in set(ours) & set(theirs))
    shown = cell("paper.md", "<!-- protocol scores -->", "5 | ours", 4)
    # Of an even number of cells the page has the geometric mean of the middle two, this the arithmetic one.
    return shown, value, math.isclose(float(shown), value, rel_tol=0.03)


def finding():
    held, seeds = 0, {row["seed"] for row in rows("paper/full")}
    for seed in seeds:
        mid, os0 = ([float(row["own_map_outliers_vertices_percent"]) for row in
                     rows("paper/full", seed=seed, world="cave", sensor=sensor, algorithm="kiss_icp")]
                    for sensor in (MID_PAPER, OS0_PAPER))
        held += bool(mid and os0 and os0[0] > mid[0])
    shown = cell("paper.md", "<!-- protocol findings -->", "KISS-ICP's Cave map is worse with the OS0-128", 2)
    return shown, held, shown == f"{held} of {len(seeds)}"


FIGURES = (drift, live_drift, lost_runs, ended, map_error, outliers, hodges_lehmann, fitted_speed, rank_correlation,
           median_factor, finding)


# Drift from two trajectories.

def trajectory(file):
    import numpy as np
    table = np.loadtxt(file)
    table = table[np.concatenate([[True], np.diff(table[:, 0]) > 0])]
    return table[:, 0], table[:, 1:4], table[:, 4:8] / np.linalg.norm(table[:, 4:8], axis=1)[:, None]


def matrix(position, q):
    import numpy as np
    x, y, z, w = q
    pose = np.eye(4)
    pose[:3, :3] = np.eye(3) + 2 * w * cross(q[:3]) + 2 * cross(q[:3]) @ cross(q[:3])
    pose[:3, 3] = position
    return pose


def cross(v):
    import numpy as np
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


def between(times, positions, quaternions, t):
    """The pose at a time between two others; the truth's are a millisecond apart, so that quaternions are mixed linearly."""
    import numpy as np
    i = min(max(int(np.searchsorted(times, t)), 1), len(times) - 1)
    share = (t - times[i - 1]) / (times[i] - times[i - 1])
    a, b = quaternions[i - 1], quaternions[i]
    q = (1 - share) * a + share * (b if a @ b > 0 else -b)
    return matrix((1 - share) * positions[i - 1] + share * positions[i], q / np.linalg.norm(q))


def drift_per_meter(truth_file, estimate_file):
    """RMSE over disjoint pieces of one meter of the truth's path, whose ends move to the nearest pose of the estimate. cm per m."""
    import numpy as np
    times, positions, quaternions = trajectory(truth_file)
    estimate = trajectory(estimate_file)
    begin, end = max(times[0], estimate[0][0]), min(times[-1], estimate[0][-1])
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(positions, axis=0), axis=1))])
    first, last = np.interp([begin, end], times, length)
    squares = []
    gap = 1.5 * np.median(np.diff(estimate[0]))
    for k in range(int(math.floor(last - first))):
        ends = []
        for s in (first + k, first + k + 1):
            i = int(np.searchsorted(length, s))  # the first instant with this length
            share = (s - length[i - 1]) / (length[i] - length[i - 1]) if i else 1.0
            t = max(times[i - 1] + share * (times[i] - times[i - 1]) if i else times[0], begin)
            j = int(np.searchsorted(estimate[0], t))
            gone = 0 < j < len(estimate[0]) and estimate[0][j] - estimate[0][j - 1] > gap
            ends.append(None if gone else int(np.argmin(abs(estimate[0] - t))))
        a, b = ends
        if None in ends or a == b:
            continue
        true = [between(times, positions, quaternions, estimate[0][i]) for i in ends]
        seen = [matrix(estimate[1][i], estimate[2][i]) for i in ends]
        error = np.linalg.inv(np.linalg.inv(true[0]) @ true[1]) @ np.linalg.inv(seen[0]) @ seen[1]
        path = abs(np.diff(np.interp(estimate[0][list(ends)], times, length))[0])
        squares.append((100 * np.linalg.norm(error[:3, 3]) / path) ** 2)
    return math.sqrt(statistics.fmean(squares))


def of_study(study):
    worst = 0.0
    for folder in sorted((study / "runs").iterdir()):
        metrics = json.loads((folder / "metrics.json").read_text())
        if metrics["status"] != "ok":
            print(f"{folder.name}: not computed, {metrics['reason']}")
            continue
        truth = folder / json.loads((folder / "manifest.json").read_text())["dataset"] / "truth.tum"
        shown = 100 * metrics["final"]["rpe"]["1m_at_poses"]["translation"]["rmse_m"]
        value = drift_per_meter(truth, folder / "trajectory.tum")
        worst = max(worst, abs(value / shown - 1))
        print(f"{folder.name}: {shown:.5g}, computed anew {value:.5g}")
    print(f"largest relative difference {worst:.2g}")


def main():
    if len(sys.argv) > 1:
        return of_study(pathlib.Path(sys.argv[1]))
    failed = 0
    for figure in FIGURES:
        shown, value, agrees = figure()
        failed += not agrees
        print(f"{'same' if agrees else 'DIFFERS'}: {figure.__name__}: the page has {shown}, the rows give {value}")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
