// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/results/claims.hpp"

#include <gmock/gmock.h>

#include "made_up_runs.hpp"

namespace lidarena::results {
namespace {

/// `seeds` runs in each of two worlds; the drift of a seed times `factor`.
std::vector<RunRecord> runs_of(const std::string& method, double factor, std::uint64_t seeds) {
  std::vector<RunRecord> runs;
  for (const char* world : {"house", "cave"}) {
    for (std::uint64_t seed = 1; seed <= seeds; ++seed)
      runs.push_back(made_up::run_of(world, "os0", method,
                                     factor * (1.0 + 0.1 * static_cast<double>(seed)), 0.0, seed));
  }
  return runs;
}

Runs pointers(const std::vector<RunRecord>& runs) {
  Runs all;
  for (const RunRecord& run : runs) all.push_back(&run);
  return all;
}

Claim claim_of(const std::vector<RunRecord>& a, const std::vector<RunRecord>& b) {
  return claims_of(std::vector<Contest>{{pointers(a), pointers(b), &kDrift}}).at(0);
}

TEST(Claims, NeedSixteenPairsPooledOverWorlds) {
  const Claim enough = claim_of(runs_of("good", 1.0, 8), runs_of("bad", 1.01, 8));
  EXPECT_EQ(enough.pairs, 16U);
  EXPECT_TRUE(enough.a_is_better);
  EXPECT_FALSE(enough.b_is_better);
  EXPECT_NEAR(*enough.p, 2.0 / 65536.0, 1e-12) << "all differences of one sign";
  const Claim few = claim_of(runs_of("good", 1.0, 7), runs_of("bad", 9.0, 7));
  EXPECT_EQ(few.pairs, 14U);
  EXPECT_FALSE(few.a_is_better);
  EXPECT_FALSE(few.p);
  EXPECT_EQ(few.words(), "14 pairs: too few for a claim");
  std::vector<RunRecord> one = runs_of("good", 1.0, 1);
  one.resize(1);
  EXPECT_EQ(claim_of(one, one).words(), "one run a cell: no claim");
}

TEST(Claims, CountTwoFlightsOfASeedOnceSinceTheyShareItsWorld) {
  std::vector<RunRecord> a = runs_of("a", 1.0, 4), b = runs_of("b", 2.0, 4);
  for (std::vector<RunRecord>* runs : {&a, &b}) {
    std::vector<RunRecord> other = *runs;
    for (RunRecord& run : other) run.flight = "another route";
    runs->insert(runs->end(), other.begin(), other.end());
  }
  const Claim claim = claim_of(a, b);
  EXPECT_EQ(claim.pairs, 16U);
  EXPECT_EQ(claim.independent, 8U) << "four seeds in two worlds";
  EXPECT_FALSE(claim.a_is_better);
  EXPECT_EQ(claim.words(), "8 pairs: too few for a claim");
}

TEST(Claims, LostRunsDecideAgainstTheMethodThatLosesThem) {
  // better on 10 of 16 pairs by 1 %, lost on the other six: without these it would be the better
  // one
  std::vector<RunRecord> good = runs_of("risky", 0.99, 8);
  const std::vector<RunRecord> safe = runs_of("safe", 1.0, 8);
  for (std::size_t i = 0; i < 6; ++i) made_up::lose(good[i]);
  const Claim claim = claim_of(good, safe);
  EXPECT_EQ(claim.pairs, 16U);
  EXPECT_FALSE(claim.a_is_better);
  std::vector<RunRecord> all_lost = safe;
  for (RunRecord& run : all_lost) made_up::lose(run);
  EXPECT_TRUE(claim_of(safe, all_lost).a_is_better);
  const Claim both = claim_of(all_lost, all_lost);
  EXPECT_FALSE(both.a_is_better || both.b_is_better);
  EXPECT_EQ(both.pairs, 0U) << "lost with both: no evidence";
  std::vector<RunRecord> once = runs_of("once", 2.0, 8), also = runs_of("also", 1.0, 8);
  made_up::lose(once[3]);
  made_up::lose(also[3]);
  EXPECT_EQ(claim_of(once, also).words(), "15 pairs: too few for a claim");
  EXPECT_EQ(claim_of(safe, safe).words(), "16 equal pairs");
}

TEST(Claims, WithinAWorldRestOnItsOwnRunsAndOverWorldsOnRanksWithinEach) {
  // sixteen flights each: in the house b is 1 % worse, in the cave it takes a third
  std::vector<RunRecord> a = runs_of("a", 1.0, 16), b = a;
  for (RunRecord& run : b)
    run.metrics->final->rpe->at_poses_1m.translation.rmse *= run.world == "house" ? 1.01 : 0.333;
  const auto of_world = [](const std::vector<RunRecord>& runs, const std::string& world) {
    Runs found;
    for (const RunRecord& run : runs)
      if (run.world == world) found.push_back(&run);
    return found;
  };
  const std::vector<Claim> claims =
      claims_of(std::vector<Contest>{{of_world(a, "house"), of_world(b, "house"), &kDrift},
                                     {of_world(a, "cave"), of_world(b, "cave"), &kDrift},
                                     {pointers(a), pointers(b), &kDrift}});
  EXPECT_TRUE(claims[0].a_is_better);
  EXPECT_TRUE(claims[1].b_is_better);
  EXPECT_FALSE(claims[2].a_is_better || claims[2].b_is_better) << "the worlds contradict";
  EXPECT_NEAR(*claims[0].ratio, 1.01, 1e-9);
  EXPECT_NEAR(claims[1].ratio_95->high, 0.333, 1e-9);
  EXPECT_EQ(claims[1].ratio_words(), "ratio 0.33 (0.33 to 0.33)");
}

TEST(Claims, AreCorrectedForTheNumberOfContestsOfATable) {
  // 16 pairs of which the three with the smallest differences have the other sign: rank sum 1 + 2 +
  // 3
  std::vector<RunRecord> a = runs_of("a", 1.0, 8), b = a;
  for (std::size_t i = 0; i < b.size(); ++i) {
    const double step = 0.01 * static_cast<double>(i + 1);
    b[i].metrics->final->rpe->at_poses_1m.translation.rmse += i < 5 ? -step : step;
  }
  const Contest contest{pointers(a), pointers(b), &kDrift};
  const double alone = *claims_of(std::vector<Contest>{contest}).at(0).p;
  ASSERT_LT(alone, 0.05);
  const std::vector<Claim> ten = claims_of(std::vector<Contest>(100, contest));
  EXPECT_NEAR(*ten[0].p, std::min(1.0, 100.0 * alone), 1e-12);
  EXPECT_FALSE(ten[0].a_is_better);
}

TEST(Claims, WhereMoreIsBetterTheLargerOneIs) {
  const Figure& figure = figure_of("real_time_factor", "");
  std::vector<RunRecord> slow = runs_of("slow", 1.0, 8), fast = slow;
  for (std::size_t i = 0; i < slow.size(); ++i) {
    slow[i].metrics->resources.scans = fast[i].metrics->resources.scans = 9;
    slow[i].metrics->resources.real_time_factor = 1.0 + 0.01 * static_cast<double>(i);
    fast[i].metrics->resources.real_time_factor = 2.0;
  }
  const Claim claim =
      claims_of(std::vector<Contest>{{pointers(slow), pointers(fast), &figure}}).at(0);
  EXPECT_TRUE(claim.b_is_better);
}

}  // namespace
}  // namespace lidarena::results
