# SPDX-License-Identifier: BSD-3-Clause
"""Checks docs/tuning.py with results whose ranks are known, and the plan."""
import csv
import json
import math
import pathlib
import tempfile
import unittest

import tuning

HOUSE, CAVE = ({"world": world, "flight": "f"} for world in ("house", "cave"))
PLAN = {
    "seconds": 20, "sensors": ["a", "b"],
    "stages": [{"study": "one", "seeds": [9101], "scenes": [HOUSE], "keep": 2},
               {"study": "two", "seeds": [9102], "scenes": [HOUSE, CAVE], "keep": 1}],
    "settings": [{"as": f"m-0{i}", "name": "m:indoor"} for i in (1, 2, 3)]
    + [{"as": "n-01", "name": "n:indoor", "parts": 2, "set": {"key": 0.1}}]}
COLUMNS = ["world", "sensor", "algorithm", "seed", "status", "reason", tuning.DRIFT,
           "rpe_1m_at_poses_rotation_deg", "live_rpe_1m_at_poses_translation_cm",
           "ate_se3_translation_cm", "cpu_load_percent"]


def rows_of(stage, drifts, cpu=1.0, status="ok"):
    """Rows of all flights of a stage: {setting: drift of every flight}."""
    for name, drift in drifts.items():
        for world, seed, sensor in tuning.flights_of(PLAN, stage):
            yield [world, sensor, name, seed, status, "", drift, 0.1, drift, drift, cpu]


class Tuning(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def results(self, name, *rows):
        file = pathlib.Path(self.folder.name) / name
        with file.open("w", newline="") as out:
            csv.writer(out).writerows([COLUMNS, *(row for some in rows for row in some)])
        return file

    def first(self):
        one = PLAN["stages"][0]
        return self.results("one.csv", rows_of(one, {"m-01": 3.0, "m-02": 1.0, "n-01": 9.0}),
                            rows_of(one, {"m-03": 2.0}))

    def names(self, text):
        return [setting["as"] for setting in json.loads(text)["algorithms"]]

    def test_the_first_study_has_all_settings_and_the_next_the_best_of_each_method(self):
        self.assertEqual(self.names(tuning.study(PLAN, "one", [])),
                         ["m-01", "m-02", "m-03", "n-01"])
        two = json.loads(tuning.study(PLAN, "two", [self.first()]))
        self.assertEqual([setting["as"] for setting in two["algorithms"]], ["m-02", "m-03", "n-01"])
        self.assertEqual(two["algorithms"][2], PLAN["settings"][3])
        self.assertEqual(two["seeds"], [9102])
        self.assertEqual(two["scenes"], [{**HOUSE, "seconds": 20}, {**CAVE, "seconds": 20}])

    def test_the_score_is_the_median_log_with_lost_as_100_cm(self):
        rows = list(rows_of(PLAN["stages"][1], {"m-01": 4.0}))
        runs = [dict(zip(COLUMNS, map(str, row))) for row in rows]
        runs[0][tuning.DRIFT] = "1"
        runs[1]["status"] = "diverged"
        runs[2][tuning.DRIFT] = "2500"
        self.assertEqual([tuning.drift_of(run) for run in runs], [1.0, 100.0, 100.0, 4.0])
        self.assertAlmostEqual(tuning.score(runs)[0], 0.5 * (math.log(4.0) + math.log(100.0)))

    def test_ties_go_to_the_lower_load(self):
        one = PLAN["stages"][0]
        file = self.results("one.csv", rows_of(one, {"m-01": 1.0}, 5.0),
                            rows_of(one, {"m-02": 1.0}, 3.0),
                            rows_of(one, {"m-03": 1.0}, 4.0), rows_of(one, {"n-01": 1.0}))
        self.assertEqual(self.names(tuning.study(PLAN, "two", [file])), ["m-02", "m-03", "n-01"])

    def test_all_flights_so_far_count(self):
        two = PLAN["stages"][1]  # four flights beside the two of the first stage
        second = self.results("two.csv", rows_of(two, {"m-02": 5.0, "m-03": 4.0, "n-01": 1.0}))
        best = tuning.write_tables(PLAN, [self.first(), second], pathlib.Path(self.folder.name))
        self.assertEqual(best, ["m-03", "n-01"])
        with (pathlib.Path(self.folder.name) / "m.csv").open(newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([row["setting"] for row in rows], ["m-03", "m-02", "m-01"])
        self.assertEqual([row["flights"] for row in rows], ["6", "6", "2"])
        self.assertEqual(rows[0]["house-9101-a"], "2")
        self.assertEqual(rows[0]["cave-9102-b"], "4")
        self.assertEqual(rows[2]["cave-9102-b"], "")
        self.assertAlmostEqual(float(rows[0]["median_rpe_cm_per_m"]), 4.0)
        page = (pathlib.Path(self.folder.name) / "n.md").read_text()
        self.assertIn("| `n-01` | indoor, parts 2, key=0.1 | 6 | 0 | 1 | 1 |", page)

    def test_a_missing_flight_and_a_row_given_twice_are_errors(self):
        one = PLAN["stages"][0]
        short = self.results("short.csv", rows_of(one, {"m-01": 1.0, "m-02": 1.0, "m-03": 1.0}))
        with self.assertRaisesRegex(tuning.PlanError, "n-01 lacks 2 of 2 flights"):
            tuning.study(PLAN, "two", [short])
        unflown = self.results("unflown.csv", rows_of(one, {"m-01": 1.0, "m-02": 1.0, "m-03": 1.0}),
                               rows_of(one, {"n-01": ""}, "", "missing"))
        with self.assertRaisesRegex(tuning.PlanError, "n-01 lacks 2 of 2 flights"):
            tuning.study(PLAN, "two", [unflown])
        with self.assertRaisesRegex(tuning.PlanError, "two rows"):
            tuning.study(PLAN, "two", [short, short])

    def test_the_plan_is_fair_and_stays_in_the_development_set(self):
        plan = json.loads((tuning.TUNING / "plan.json").read_text())
        methods = [tuning.method_of(setting) for setting in plan["settings"]]
        self.assertEqual({method: methods.count(method) for method in methods},
                         dict.fromkeys(("ct_icp", "kiss_icp", "lio_sam", "fast_lio2"), 32))
        tried = [json.dumps({**setting, "as": ""}, sort_keys=True) for setting in plan["settings"]]
        self.assertEqual(len(set(tried)), len(tried))
        flights = [flight for stage in plan["stages"] for flight in tuning.flights_of(plan, stage)]
        self.assertEqual(len(set(flights)), len(flights))
        self.assertEqual(len(flights), 24)
        self.assertTrue(all(9000 <= seed <= 9999 for _, seed, _ in flights))


if __name__ == "__main__":
    unittest.main()
