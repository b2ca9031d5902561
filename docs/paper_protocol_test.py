# SPDX-License-Identifier: BSD-3-Clause
"""Checks docs/paper_protocol.py against cases that can be computed by hand."""
import csv
import itertools
import math
import pathlib
import random
import re
import tempfile
import unittest

import paper_protocol as protocol
from paper_protocol import DRIFT, GPU, MID, OS0, OUTLIERS, RMSE

STUDIES = pathlib.Path(__file__).resolve().parent.parent / "configs" / "studies"
PAPER = protocol.read_paper()


def run(cell, value, seed=101, speed=None, status="ok", world=None, **more):
    row = {"world": world or cell[0], "sensor": cell[1], "algorithm": cell[2], "seed": str(seed),
           "status": status, DRIFT: str(value), OUTLIERS: "", RMSE: "", protocol.MEMORY: "0.99"}
    return row | ({} if speed is None else {protocol.SPEED: str(speed)}) | more


def papers_runs(seed=101, scale=lambda cell: 1.0):
    """The paper's own figures as if they were runs, times a scale."""
    return [run(cell, PAPER[DRIFT, cell] * scale(cell), seed,
                **{OUTLIERS: str(PAPER[OUTLIERS, cell]), RMSE: str(PAPER[RMSE, cell])})
            for cell in protocol.CELLS]


class Paper(unittest.TestCase):
    def test_has_three_tables_of_twenty(self):
        self.assertEqual(len(PAPER), 60)
        self.assertEqual({cell for _, cell in PAPER}, set(protocol.CELLS))
        self.assertEqual(PAPER[DRIFT, ("cave", OS0, "kiss_icp")], 8.17)
        self.assertEqual(PAPER[OUTLIERS, ("house", OS0, "lio_sam")], 9.34e-4)
        self.assertEqual(PAPER[RMSE, ("house", MID, "fast_lio2")], 5.27)


class Speed(unittest.TestCase):
    CURVE = [(0.5, 1.0), (0.75, 2.0), (1.0, 8.0)]

    def test_a_power_law_is_found_back(self):
        curve = [(s, 3.0 * s ** 2) for s in (0.5, 0.75, 1.0)]
        for s in (0.5, 0.6, 0.8, 1.0):
            self.assertAlmostEqual(protocol.fitted_speed(curve, 3.0 * s ** 2)[0], s)
            self.assertAlmostEqual(protocol.at_speed(curve, s), 3.0 * s ** 2)
        self.assertAlmostEqual(protocol.at_speed(curve, 0.4), 3.0 * 0.4 ** 2)
        self.assertAlmostEqual(protocol.at_speed(curve, 1.3), 3.0 * 1.3 ** 2)

    def test_the_lines_are_straight_in_logarithms_piece_by_piece(self):
        self.assertAlmostEqual(protocol.fitted_speed(self.CURVE, 4.0)[0], math.sqrt(0.75 * 1.0))
        self.assertAlmostEqual(protocol.at_speed(self.CURVE, math.sqrt(0.75)), 4.0)
        self.assertEqual(protocol.at_speed(self.CURVE, 0.75), 2.0)

    def test_what_cannot_fix_a_speed(self):
        def why(curve, value):
            return protocol.fitted_speed(curve, value)[1]
        self.assertEqual(why([(0.5, 1.0), (0.75, 3.0), (1.0, 2.0)], 1.5), "not monotonic")
        self.assertEqual(why([(0.5, 1.0), (0.75, 1.0), (1.0, 2.0)], 1.5), "not monotonic")
        self.assertEqual(why(self.CURVE, 0.9), "does not bracket")
        self.assertEqual(why(self.CURVE, 8.1), "does not bracket")
        self.assertEqual(why([(0.5, 1.0), (0.75, 2.0), (1.0, math.inf)], 1.5), "a run ended itself")

    def test_the_first_cell_of_the_order_that_can_fixes_it(self):
        first, second, third = protocol.FIT_ORDER[:3]
        paper = {(DRIFT, c): 4.0 for c in (first, second, third)}
        curves = {first: [(0.5, 5.0), (0.75, 6.0), (1.0, 7.0)], third: self.CURVE, second: self.CURVE}
        cell, speed = protocol.fit(curves, paper)
        self.assertEqual(cell, second)
        self.assertAlmostEqual(speed, math.sqrt(0.75))
        self.assertEqual(first, ("house", MID, "fast_lio2"))
        self.assertEqual(sorted(protocol.FIT_ORDER), sorted(protocol.CELLS))
        with self.assertRaises(SystemExit):
            protocol.fit({first: curves[first]}, paper)

    def test_curves_are_medians_over_worlds_open_houses_among_them(self):
        cell = ("house", MID, "ct_icp")
        runs = [run(cell, v, seed, speed, world=world)
                for speed in (0.5, 1.0) for seed, v, world in
                ((101, 1.0 * speed, "house"), (102, 7.0 * speed, "house_open"), (103, 3.0 * speed, "house"))]
        self.assertEqual(protocol.curves_of(runs), {cell: [(0.5, 1.5), (1.0, 3.0)]})
        runs += [run(cell, "", seed, 1.0, "diverged") for seed in (104, 105)]
        self.assertEqual(protocol.curves_of(runs)[cell][1], (1.0, 7.0))


class Scores(unittest.TestCase):
    def test_ranks_and_their_correlation(self):
        self.assertEqual(protocol.ranks_of([3.0, 1.0, 3.0, math.inf]), [2.5, 1.0, 2.5, 4.0])
        self.assertAlmostEqual(protocol.rank_correlation([1, 2, 3], [10, 100, 1000]), 1.0)
        self.assertAlmostEqual(protocol.rank_correlation([3, 2, 1], [10, 100, 1000]), -1.0)
        # 1 - 6 sum d^2 / (n (n^2 - 1)) with d = 1, 1, 0, 0
        self.assertAlmostEqual(protocol.rank_correlation([2, 1, 3, 4], [1, 2, 3, 4]), 1 - 6 * 2 / 60)
        self.assertEqual(protocol.rank_correlation([1, 1, 1], [1, 2, 3]), 0.0)

    def test_the_median_factor(self):
        self.assertAlmostEqual(protocol.median_factor([2.0, 1.0, 9.0], [1.0, 3.0, 3.0]), 3.0)
        self.assertAlmostEqual(protocol.median_factor([2.0, 6.0], [4.0, 1.0]), math.sqrt(12.0))
        self.assertEqual(protocol.median_factor([math.inf, math.inf, 1.0], [1.0, 1.0, 1.0]), math.inf)
        self.assertEqual(protocol.share_within([2.0, 0.4, 7.0, math.inf], [1.0, 1.0, 1.0, 1.0], 2), "1 of 4")

    def test_chance_is_the_share_of_all_permutations(self):
        ours, paper = [2.0, 1.0, 3.0, 4.0], [1.0, 2.0, 3.0, 4.0]
        as_high = sum(protocol.rank_correlation(p, paper) >= 0.8 - 1e-12 for p in itertools.permutations(ours))
        found = protocol.chance(ours, paper, [0] * 4, permutations=20_000)
        share = as_high / 24
        self.assertAlmostEqual(found, share, delta=4 * math.sqrt(share * (1 - share) / 20_000))

    def test_chance_within_groups_moves_nothing_else(self):
        ours, paper, groups = [2.0, 1.0, 30.0, 40.0], [1.0, 2.0, 30.0, 40.0], [0, 0, 1, 1]
        # Of the four permutations within the pairs three are at least as good as ours.
        self.assertAlmostEqual(protocol.chance(ours, paper, groups, 20_000), 0.75, delta=0.015)
        self.assertEqual(protocol.chance(ours, paper, [0, 1, 2, 3], 100), 1.0)

    def test_the_dumb_predictors_are_geometric_means_of_row_and_column(self):
        paper = {(DRIFT, (w, s, m)): {"cave": 1.0, "house": 4.0}[w] * (9.0 if m == "kiss_icp" else 1.0)
                 for w, s, m in protocol.CELLS}
        kiss = ("cave", OS0, "kiss_icp")
        self.assertAlmostEqual(protocol.mean_of(paper, DRIFT, kiss, by_method=True), 18.0)
        self.assertAlmostEqual(protocol.mean_of(paper, DRIFT, kiss, by_method=False), 9.0 ** (1 / 5))

    def test_the_papers_own_figures_score_perfectly_and_beat_both_predictors(self):
        fitted = protocol.FIT_ORDER[0]
        rows = protocol.table_scores(PAPER, papers_runs(), fitted)
        self.assertEqual(len(rows), 10)
        for row in rows[1:]:
            cells = "19" if row[0] == "2" else "20"
            self.assertEqual(row[2], cells)
            if row[1] == "ours":
                self.assertEqual(row[3:7], ["1.00", "1.00", f"{cells} of {cells}", f"{cells} of {cells}"])
                self.assertLess(float(row[7]), 0.001)
                self.assertLess(float(row[8]), 0.01)
                self.assertEqual(row[10], "succeeds")
            else:
                self.assertLess(float(row[3]), 1.0)
                self.assertEqual(row[7:], [""] * 4)

    def test_random_figures_score_nothing(self):
        random.seed(4)
        runs = papers_runs(scale=lambda cell: math.exp(random.gauss(0, 3)) / PAPER[DRIFT, cell])
        row = protocol.table_scores(PAPER, runs, protocol.FIT_ORDER[0])[1]
        self.assertLess(abs(float(row[3])), 0.5)
        self.assertGreater(float(row[7]), 0.02)
        self.assertEqual(row[10], "fails by rank correlation and median factor and chance")

    def test_a_map_without_outliers_counts_as_the_least_share(self):
        cell = protocol.CELLS[0]
        runs = papers_runs()
        runs[0][OUTLIERS] = "0"
        _, ours, theirs = protocol.compare(protocol.medians_of(runs, OUTLIERS), PAPER, OUTLIERS)
        self.assertEqual((ours[0], theirs[0]), (protocol.LEAST, PAPER[OUTLIERS, cell]))


class Tables(unittest.TestCase):
    def speeds(self):
        """Every cell is the paper's at speed 0.8, with an exponent of its own."""
        return [run(cell, PAPER[DRIFT, cell] * (speed / 0.8) ** (1 + i % 3), seed, speed)
                for i, cell in enumerate(protocol.CELLS) for speed in (0.5, 0.75, 1.0) for seed in (101, 102)]

    def test_each_cell_in_its_turn_finds_the_same_speed_of_a_perfect_simulation(self):
        rows = protocol.table_turns(PAPER, self.speeds())
        self.assertEqual(len(rows), 21)
        for row in rows[1:]:
            self.assertEqual(row[1:], ["0.800", "19", "1.00", "1.00"])
        fits = protocol.table_fit(PAPER, self.speeds())
        self.assertEqual([row[-1] for row in fits[1:]].count("0.800"), 19)
        self.assertEqual(next(r[-1] for r in fits if r[0] == "House, Mid-360: FAST-LIO2"), "**0.800**")

    def test_a_second_speed_for_the_cave_is_a_second_free_number(self):
        runs = [row | {DRIFT: str(float(row[DRIFT]) * (2.0 if row["world"] == "cave" else 1.0))}
                for row in self.speeds()]
        for row in runs:  # of FAST-LIO2 in the Cave: the paper's at 0.6
            if row["world"] == "cave" and row["algorithm"] == "fast_lio2":
                row[DRIFT] = str(PAPER[DRIFT, protocol.cell_of(row)] * float(row[protocol.SPEED]) / 0.6)
        one, two = protocol.table_two_speeds(PAPER, runs)[1:]
        self.assertEqual(one[:4], ["1", "0.800", "0.800", "19"])
        self.assertEqual(two[:4], ["2", "0.600", "0.800", "18"])

    def test_values_have_median_range_and_the_runs_that_ended_well(self):
        cell = protocol.CELLS[0]
        runs = [run(cell, v, seed) for seed, v in ((101, 3.0), (102, 1.0), (103, 2.0))]
        runs.append(run(cell, "", 104, status="diverged"))
        row = protocol.table_cells(PAPER, runs)[1]
        self.assertEqual(row[1:3] + row[-1:], ["1.78", "2.5 (1 to 3)", "3 of 4"])
        runs += [run(cell, "", seed, status="failed") for seed in (105, 106)] + [run(cell, "", 107)]
        self.assertEqual(protocol.table_cells(PAPER, runs)[1][2], "ended (1 to 3)")

    def test_an_arm_replaces_its_cells_and_no_others(self):
        arms = [run(("cave", OS0, "kiss_fixed"), 9.0), run(("cave", GPU, "ct_icp"), 5.0),
                run(("cave", MID, "lio_sam_lc_shipped"), 6.0), run(("cave", MID, "lio_sam_shipped"), 7.0)]
        ramp = [run(("cave", MID, "fast_lio2"), 8.0, **{"sensor.ramp_s": "0.05"})]
        rows = protocol.table_arms(PAPER, papers_runs(), arms, ramp, protocol.FIT_ORDER[0])
        found = {row[0]: row for row in rows[1:]}
        self.assertEqual(found["base"][1:4], ["0", "1.00", "1.00"])
        self.assertEqual(found["KISS-ICP, cells of half a meter"][1], "1")
        self.assertIn("Cave, OS0-128: KISS-ICP 8.17, 9 (8.17)", found["KISS-ICP, cells of half a meter"][4])
        self.assertIn("Cave, OS0-128: CT-ICP 1.53, 5 (1.53)", found["gpu_ray instead of the OS0-128"][4])
        self.assertEqual(found["LIO-SAM, files as shipped"][1], "2")
        self.assertEqual(found["times of a ramp of 50 ms"][1], "1")

    def test_every_arm_is_a_method_of_the_studies(self):
        text = (STUDIES / "paper_arms.yaml").read_text()
        self.assertEqual(set(re.findall(r"\bas: (\w+)", text)), set(protocol.ARMS))


class Findings(unittest.TestCase):
    def test_are_those_of_the_study(self):
        named = re.findall(r"^  - finding: (.*)$", (STUDIES / "paper.yaml").read_text(), re.MULTILINE)
        self.assertEqual(named, list(protocol.FINDINGS))

    def test_all_hold_on_the_papers_own_figures(self):
        for row in protocol.table_findings(papers_runs(), [], [])[1:]:
            self.assertEqual(row[1:5], ["confirmed", "1 of 1", "0 of 1", "0 of 1"], row[0])

    def test_each_can_fail(self):
        """Each fails when the methods', the sensors' or the worlds' figures are exchanged."""
        def exchanged(change):
            changed = {}
            for column, cell in list(PAPER):
                changed[column, change(cell)] = PAPER[column, cell]
            figures = dict(changed)
            for cell in protocol.CELLS:
                figures[protocol.MEMORY, cell] = 0.5
            return figures
        swaps = [{"fast_lio2": "kiss_icp", "kiss_icp": "fast_lio2"}, {MID: OS0, OS0: MID},
                 {"cave": "house", "house": "cave"}, {"lio_sam": "lio_sam_lc", "lio_sam_lc": "lio_sam"},
                 {"ct_icp": "kiss_icp", "kiss_icp": "ct_icp"}, {"fast_lio2": "lio_sam", "lio_sam": "fast_lio2"}]
        for finding in protocol.FINDINGS:
            answers = {protocol.judge(finding, exchanged(lambda c, s=s: tuple(s.get(p, p) for p in c)))
                       for s in swaps}
            self.assertIn(False, answers, finding)

    def test_are_judged_in_each_pair_of_worlds(self):
        finding = "CT-ICP's drift hardly depends on the sensor"
        good, bad = papers_runs(101), papers_runs(102)
        for row in bad:
            if row["sensor"] == MID and row["algorithm"] == "ct_icp":
                row[DRIFT] = "9"
        lost = papers_runs(103)
        for row in lost:
            if row["algorithm"] == "ct_icp":
                row["status"] = "diverged"
        rows = {row[0]: row[1:] for row in protocol.table_findings(good + bad + lost, [], [])}
        self.assertEqual(rows[finding][:4], ["depends on the world", "1 of 3", "1 of 3", "1 of 3"])

    def test_an_arm_that_saves_a_finding_is_named(self):
        finding = "KISS-ICP has the highest drift"
        full = [row for seed in (101, 102, 103) for row in papers_runs(seed)]
        for row in full:
            if row["algorithm"] == "kiss_icp":
                row[DRIFT] = "0.1"

        def of_arm(seeds):
            return [run((world, sensor, "kiss_from_5m"), 99.0, seed) for seed in seeds
                    for world in ("cave", "house") for sensor in (MID, OS0)]
        other = [run(("cave", MID, "ct_icp_driving"), 1.5, seed) for seed in (101, 102, 103)]
        for seeds, named, verdict in (((101, 102), "KISS-ICP, points from 5 m on", "fails, but for an arm"),
                                      ((101,), "none", "contradicted")):
            rows = {row[0]: row[1:] for row in protocol.table_findings(full, of_arm(seeds) + other, [])}
            self.assertEqual(rows[finding], [verdict, "0 of 3", "3 of 3", "0 of 3", "0 of 3", named])
        rows = {row[0]: row[1:] for row in protocol.table_findings(full, [], [])}
        self.assertEqual(rows[finding][0], "fails; the arms are not flown")


class Files(unittest.TestCase):
    def test_a_page_gets_the_tables_of_the_files(self):
        with tempfile.TemporaryDirectory() as folder:
            data, protocol.DATA = protocol.DATA, pathlib.Path(folder)
            try:
                runs = papers_runs()
                with (protocol.DATA / "full.csv").open("w", newline="") as file:
                    writer = csv.DictWriter(file, runs[0])
                    writer.writeheader()
                    writer.writerows(runs)
                page = "a\n<!-- protocol cells -->\nold\n<!-- end protocol -->\nb\n"
                renewed = protocol.renewed(page)
                self.assertIn("| 20.06 | 20.1 (20.1 to 20.1) | 1 of 1 |", renewed)
                self.assertNotIn("old", renewed)
                self.assertEqual(protocol.renewed(renewed), renewed)
                with self.assertRaises(SystemExit):
                    protocol.block("fit")  # no speeds.csv
                with self.assertRaises(SystemExit):
                    protocol.block("none")
            finally:
                protocol.DATA = data


if __name__ == "__main__":
    unittest.main()
