#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Draws the cells of the paper's tables 2, 4 and 5, ours against the paper's: docs/images/paper_cells.png.

usage: draw_paper.py FILE
"""
import math
import statistics
import sys

import matplotlib

from paper_protocol import METHODS, MID, NAMES, OS0, TABLES, floored, read_paper, read_runs, values_of

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402


def draw(file):
    """Each cell's median and range over the worlds against the paper's value. A run that ended itself stands at the upper edge."""
    paper, full = read_paper(), read_runs("full")
    colors = dict(zip(METHODS, ("#1f77b4", "#d62728", "#9467bd", "#2ca02c", "#ff7f0e")))
    marks = {("cave", MID): "o", ("cave", OS0): "s", ("house", MID): "^", ("house", OS0): "D"}
    titles = ("Table 2: drift, cm per m", "Table 4: points beyond 20 cm, %", "Table 5: RMSE of the map, cm")
    figure, places = plt.subplots(1, 3, figsize=(14, 5.2))
    for place, (column, title) in zip(places, zip(TABLES.values(), titles)):
        cells = {cell: [floored(v, column) for v in some] for cell, some in values_of(full, column).items()}
        theirs = [floored(paper[column, cell], column) for cell in cells]
        known = theirs + [v for some in cells.values() for v in some if math.isfinite(v)]
        low, high = min(known) / 1.6, max(known) * 2.5
        for factor, style in ((1, "-"), (2, ":"), (0.5, ":")):
            place.plot([low, high], [low * factor, high * factor], style, color="#999999", lw=1, zorder=0)
        for cell, x in zip(cells, theirs):
            shown = [min(v, high) for v in cells[cell]]
            place.plot([x, x], [min(shown), max(shown)], "-", color=colors[cell[2]], lw=1, alpha=0.5)
            place.plot(x, min(statistics.median(cells[cell]), high), marks[cell[:2]], color=colors[cell[2]], ms=6, clip_on=False)
        place.set(xscale="log", yscale="log", xlim=(low, high), ylim=(low, high), title=title,
                  xlabel="the paper", ylabel="made anew, median and range")
        place.set_aspect("equal")
    keys = [plt.Line2D([], [], marker="o", ls="", color=c, label=NAMES[m]) for m, c in colors.items()]
    keys += [plt.Line2D([], [], marker=m, ls="", color="#444444", label=f"{NAMES[w]}, {NAMES[s]}")
             for (w, s), m in marks.items()]
    figure.legend(handles=keys, loc="lower center", ncol=9, frameon=False, fontsize=8)
    figure.tight_layout(rect=(0, 0.06, 1, 1))
    figure.savefig(file)


if __name__ == "__main__":
    draw(sys.argv[1])
