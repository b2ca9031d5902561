# SPDX-License-Identifier: BSD-3-Clause
"""Checks docs/ratios.py against closed forms, tables and all combinations of signs."""
import itertools
import math
import random
import unittest

from ratios import critical_sum, distribution, log_ratio, ratio, strata_of


class Ratios(unittest.TestCase):
    def test_the_median_of_the_means_of_pairs(self):
        self.assertAlmostEqual(ratio([[1.0, 2.0, 6.0]])[0], math.exp(2.75))
        self.assertIsNone(ratio([[1.0, 2.0, 6.0]])[1])

    def test_the_critical_values_of_the_tables(self):
        for n, critical in ((6, 0), (8, 3), (10, 8), (16, 29)):
            self.assertEqual(critical_sum([[0.0] * n], n + 1), 2 * critical)

    def test_the_distribution_of_two_worlds_is_that_of_all_signs(self):
        weights = [1, 2, 2, 5]
        sums = [sum(w for w, sign in zip(weights, signs) if sign)
                for signs in itertools.product((0, 1), repeat=len(weights))]
        for total, probability in distribution(weights).items():
            self.assertAlmostEqual(probability, sums.count(total) / len(sums))

    def test_the_interval_of_one_world_has_the_order_statistics_of_its_means(self):
        random.seed(1)
        d = [random.gauss(0.2, 1.0) for _ in range(8)]
        means = sorted(0.5 * (d[i] + d[k]) for i in range(8) for k in range(i, 8))
        low, high = ratio([d])[1]
        self.assertAlmostEqual(math.log(low), means[3])
        self.assertAlmostEqual(math.log(high), means[-4])

    def test_lost_runs(self):
        self.assertEqual(log_ratio(1.0, math.inf), math.inf)
        self.assertEqual(log_ratio(math.inf, 1.0), -math.inf)
        self.assertIsNone(log_ratio(math.inf, math.inf))
        self.assertEqual(strata_of([("a", 1.0, 1.0), ("a", math.inf, math.inf), ("b", 1, math.e)]),
                         [[0.0], [1.0]])


if __name__ == "__main__":
    unittest.main()
