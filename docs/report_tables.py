# SPDX-License-Identifier: BSD-3-Clause
"""Tables of the report of a study that varies settings, for the pages of docs/results.

`stored` has such tables by their id. A column is ID=HEAD, or FINAL_ID/LIVE_ID=HEAD for both figures in a cell; HEAD has _
for blanks.
"""
import functools
import itertools
import math
import re
import statistics


CELLS = {"drift": "rpe_1m_at_poses_translation_cm", "live-drift": "live_rpe_1m_at_poses_translation_cm",
         "map": "own_map_rmse_cm"}  # tables with a row for each sensor


def tables_of(columns):
    """The ids that columns name."""
    return sorted({table for column in columns for table in column.partition("=")[0].split("/")})


def cell_text(cell, live=None):
    """With its range, how many of how many runs kept track, if one did not, and the live figure."""
    spread = re.sub(r"(?:, |^)(\d+) of \1$", "", cell.get("spread", ""))
    text = cell.get("text") or "-"
    if cell.get("bold"):
        text = f"**{text}**"
    if live and live.get("text") and text != "lost":
        text += f" / {live['text']} live"
    return f"{text} ({spread})" if spread else text


def side_by_side(stored, columns, names):
    """Markdown with a row for each variation or sensor; `names`: of both and of methods, in words."""
    head, rows = [""], {}
    for tables, _, title in (column.partition("=") for column in columns):
        final, _, live = tables.partition("/")
        live_rows = {row[0]["text"]: row for row in stored[live]["rows"]} if live else {}
        methods = [re.sub(r"^[^,]+, | \(tuned\)$", "", method) for method in stored[final]["head"][1:]]
        for i, method in enumerate(methods, 1):
            label = title.replace("_", " ")
            head.append(f"{label}, {names.get(method, f'`{method}`')}" if len(methods) > 1 else label)
            for row in stored[final]["rows"]:
                live_cell = live_rows[row[0]["text"]][i] if live else None
                rows.setdefault(row[0]["text"], {})[head[-1]] = cell_text(row[i], live_cell)
    lines = ["| " + " | ".join(head) + " |", "|---|" + "---|" * (len(head) - 1)]
    lines += [f"| {names.get(name, name)} | " + " | ".join(cells.get(title, "-") for title in head[1:]) + " |" for name, cells in rows.items()]
    return "\n".join(lines)


def median_of(runs, column, judged, found, title, variation):
    """Median of the runs of a cell, None without any. `found`: a match with the world as second group."""
    sensor, method, preset = re.fullmatch(r"([^,]+), (\S+)(?: \((\w+)\))?", title).groups("")
    values = [judged(run, column) for run in runs
              if (run["world"], run["sensor"], run["algorithm"], run["preset"], run.get("variation") or "base")
              == (found[2], sensor, method, preset, variation)]
    values = [value for value in values if value is not None]
    return statistics.median(values) if values else None


def column_of(found, runs):
    """The column of results.csv with the figure that a table's id names first."""
    column, = (c for c in runs[0] if re.fullmatch(found[1] + "_(cm|percent|deg|MB)", c))
    return column


def wrong_medians(stored, runs, judged):
    """Cells of the sweeps that are not the median of the runs. `judged(run, column)`: infinite for a lost run."""
    for name, table in stored.items():
        if not (found := re.fullmatch(r"sweep-(\w+)-(\w+)", name) or re.fullmatch(r"([a-z-]+)-(\w+)-", name)):
            continue
        column = CELLS.get(found[1]) or column_of(found, runs)
        for label, *cells in table["rows"]:
            for title, cell in zip(table["head"][1:], cells):
                of_sensors = found[1] in CELLS
                column_title, variation = (f"{label['text']}, {title}", "base") if of_sensors else (title, label["text"])
                median = median_of(runs, column, judged, found, column_title, variation)
                median = math.nan if median is None else median
                told = math.inf if cell.get("text", "") == "lost" or cell.get("text", "").startswith("ended") else cell.get("value", math.nan)
                if told != median and not math.isclose(told, median, rel_tol=1e-6) and not (math.isnan(told) and math.isnan(median)):
                    yield f"{name}, {label['text']}, {title}: {cell}, but the runs give {median}"


def shapley_values(worth, names):
    """The mean, over all orders, of what each of the names adds. `worth(names)`: of some of them, in their order."""
    orders = list(itertools.permutations(names))
    gains = dict.fromkeys(names, 0.0)
    for order in orders:
        for i, name in enumerate(order):
            before, after = ([n for n in names if n in order[:k]] for k in (i, i + 1))
            gains[name] += (worth(after) - worth(before)) / len(orders)
    return gains


def wrong_contributions(stored, runs, judged):
    """Cells of the contributions that the medians of the runs do not give. A lost median has none."""
    for name, table in stored.items():
        if not (found := re.fullmatch(r"contributions-(\w+)-(\w+)", name)):
            continue
        column = column_of(found, runs)
        labels = [row[0]["text"] for row in table["rows"]]
        changes = labels[1:-1]
        for i, title in enumerate(table["head"][1:], 1):
            @functools.cache
            def worth(some):
                return median_of(runs, column, judged, found, title, " + ".join(some) or "base")
            expected = {"base": worth(()), "all": worth(tuple(changes))}
            expected |= shapley_values(lambda some: worth(tuple(some)), changes)
            for label, row in zip(labels, table["rows"]):
                told = row[i].get("value", math.inf)
                if told != expected[label] and not math.isclose(told, expected[label], rel_tol=1e-6, abs_tol=1e-9):
                    yield f"{name}, {label}, {title}: {row[i]['text']}, but the runs give {expected[label]}"


def faults_of(stored, runs, judged):
    return [*wrong_medians(stored, runs, judged), *wrong_contributions(stored, runs, judged)]
