#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Updates docs/results from a study's report.

usage: renew_results.py STUDY [--as PREFIX]

Replaces each file that exists in docs/results/tables and docs/results/figures, and results.csv, by
the file of the same name from the report in STUDY; to add a file, create an empty one of its name
first. With --as only the tables named PREFIX-... are replaced (a study other than the main one).
Then updates the tables in docs/results/index.md: the text between the lines
`<!-- tables/NAME.md -->` and `<!-- end -->` becomes that table, with display names.
"""
import argparse
import pathlib
import re
import shutil
import sys

RESULTS = pathlib.Path(__file__).resolve().parent / "results"
NAMES = {
    "livox_mid360_paper": "Mid-360",
    "livox_mid360": "Mid-360",
    "ouster_os0_128_paper": "OS0-128",
    "ouster_os0_128": "OS0-128",
    "ct_icp": "CT-ICP",
    "kiss_icp": "KISS-ICP",
    "lio_sam_lc": "LIO-SAM lc",
    "lio_sam": "LIO-SAM",
    "fast_lio2": "FAST-LIO2",
    "arena_lo": "arena_lo",
    "arena_lio": "arena_lio",
    "arena_slam": "arena_slam",
}
OTHER_STUDIES = ("brisk-", "timing-")  # prefixes of other studies' tables
MARK = re.compile(r"(<!-- tables/(\S+)\.md -->\n).*?(<!-- end -->)", re.DOTALL)


def replace_files(source, target, prefix):
    """Replaces the files PREFIX* of `target`; returns the names that `source` lacks."""
    missing = []
    for old in sorted(target.iterdir()):
        if not old.is_file() or not old.name.startswith(prefix):
            continue
        new = source / old.name.removeprefix(prefix)
        if new.exists():
            shutil.copyfile(new, old)
        elif prefix or not old.name.startswith(OTHER_STUDIES):
            missing.append(old.name)
    return missing


def table_of(markdown):
    """Only the rows, without title and note, with display names."""
    rows = "".join(line + "\n" for line in markdown.splitlines() if line.startswith("|"))
    return re.sub(r"\b(%s)\b" % "|".join(NAMES), lambda name: NAMES[name[1]], rows)


def with_tables(page):
    """`page` with each marked table replaced by the content of its file."""
    def replaced(found):
        table = table_of((RESULTS / "tables" / (found[2] + ".md")).read_text())
        return f"{found[1]}\n{table}\n{found[3]}"
    return MARK.sub(replaced, page)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("study", type=pathlib.Path)
    parser.add_argument("--as", dest="prefix", metavar="PREFIX")
    arguments = parser.parse_args()
    prefix = arguments.prefix + "-" if arguments.prefix else ""
    if not (arguments.study / "tables").is_dir():
        sys.exit(f"{arguments.study} contains no report; run: lidarena report {arguments.study}")
    missing = replace_files(arguments.study / "tables", RESULTS / "tables", prefix)
    if not prefix:
        missing += replace_files(arguments.study / "figures", RESULTS / "figures", prefix)
        shutil.copyfile(arguments.study / "results.csv", RESULTS / "results.csv")
    index = RESULTS / "index.md"
    index.write_text(with_tables(index.read_text()))
    if missing:
        sys.exit("not in this report, left unchanged: " + ", ".join(missing))


if __name__ == "__main__":
    main()
