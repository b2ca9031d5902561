# SPDX-License-Identifier: BSD-3-Clause
"""How well the nodes of a cluster are used by a study, from measured times.

usage: cluster_efficiency.py STUDY [--nodes 1,2,4,16,64] [--seeds N] [--overhead S]

STUDY is the folder of a study that has been done: the times of its flights and runs are in its request.json files. The
study is repeated for N seeds (as many units as there are datasets, each N times), and tasks, one on each node, take the
units in the order of the plan, as lidarena's workers do. Efficiency is the work divided by nodes times duration; what ends
it is the longest unit (then more nodes do not help) or units that begin last (then they do not fit).
"""
import argparse
import heapq
import json
import pathlib


def seconds_in(folder):
    try:
        return json.loads((folder / "request.json").read_text())["result"]["seconds"]
    except (OSError, KeyError, ValueError):
        return 0.0


def units_of(study):
    """Measured seconds of each unit, in the order of the plan: its flight and all its runs."""
    plan = json.loads((study / "plan.json").read_text())
    units = []
    for unit in plan["units"]:
        runs = [seconds_in(study / "runs" / plan["runs"][cell]["name"]) for cell in unit["cells"]]
        units.append((seconds_in(study / "datasets" / unit["dataset"]) + sum(runs), len(runs)))
    return units


def duration(units, nodes, overhead):
    """Seconds until the last node is done."""
    free = [0.0] * nodes
    for seconds, _ in units:
        heapq.heappush(free, heapq.heappop(free) + seconds + overhead)
    return max(free)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("study", type=pathlib.Path)
    parser.add_argument("--nodes", default="1,2,4,16,64")
    parser.add_argument("--seeds", type=int, default=1, help="repetitions of each unit")
    parser.add_argument("--overhead", type=float, default=0.0, help="seconds between two units of a task")
    chosen = parser.parse_args()
    units = [unit for unit in units_of(chosen.study) for _ in range(chosen.seeds)]
    work, longest = sum(seconds for seconds, _ in units), max(seconds for seconds, _ in units)
    print(f"{len(units)} datasets, {sum(runs for _, runs in units)} runs, {work:.0f} s of work, "
          f"{longest:.0f} s the longest dataset")
    for nodes in map(int, chosen.nodes.split(",")):
        took = duration(units, nodes, chosen.overhead)
        ends = "the longest dataset" if took < longest + chosen.overhead + 1e-6 else "whole datasets do not divide evenly"
        if len(units) < nodes:
            ends = f"only {len(units)} datasets"
        efficiency = work / nodes / took
        print(f"{nodes:4} nodes: {took:8.0f} s, speed-up {work / took:5.1f}, efficiency {100 * efficiency:5.1f} %"
              + ("" if efficiency > 0.99 else f", limited by: {ends}"))


if __name__ == "__main__":
    main()
