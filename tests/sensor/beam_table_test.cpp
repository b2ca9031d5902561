// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/beam_table.hpp"

#include <gtest/gtest.h>

#include "lidarena/base/parallel.hpp"
#include "tests/sensor/worlds.hpp"

namespace lidarena::sensor {
namespace {

using namespace testing;
using namespace world::testing;

bool same_beams(std::span<const Beam> a, std::span<const Beam> b) {
  return std::ranges::equal(a, b, [](const Beam& p, const Beam& q) {
    return p.direction == q.direction && p.dt_ns == q.dt_ns && p.ring == q.ring &&
           p.origin == q.origin;
  });
}

TEST(BeamTable, GivesThePatternsBeamsToTheLastBitInEveryTurnOfIt) {
  for (const SensorConfig& config : {mid360(), ouster()}) {
    const auto pattern = make_pattern(config);
    const BeamTable table(*pattern);
    std::vector<Beam> storage, expected;
    for (const std::uint64_t index : {0U, 7U, 7U, 119U, 120U, 127U, 1207U}) {
      pattern->beams(index, expected);
      EXPECT_TRUE(same_beams(table.beams(index, storage), expected)) << index;
    }
  }
}

TEST(BeamTable, TheMid360RepeatsAfterTwelveSecondsAndAnOusterAtOnce) {
  EXPECT_EQ(make_pattern(mid360())->repeats_after(), 120U);
  EXPECT_EQ(make_pattern(ouster())->repeats_after(), 1U);
  // 2.4 million directions and one scan of whole beams; without a table, only the scan.
  EXPECT_EQ(BeamTable(*make_pattern(mid360())).bytes(), 2'400'000 * 12U + 20'000 * 32U);
  EXPECT_EQ(BeamTable(*make_pattern(ouster())).bytes(), 512 * 128 * 32U);
}

TEST(BeamTable, ManyThreadsMayAskForTheSameScanAtOnce) {
  const auto pattern = make_pattern(mid360());
  const BeamTable table(*pattern);
  std::vector<char> right(64, 0);
  Parallel(5).for_each(right.size(), 1, [&](std::size_t i) {
    std::vector<Beam> storage, expected;
    pattern->beams(i % 3, expected);
    right[i] = same_beams(table.beams(i % 3, storage), expected);
  });
  EXPECT_EQ(std::ranges::count(right, 1), 64);
}

/// A pattern whose firing times differ from scan to scan.
class VaryingPattern : public ScanPattern {
 public:
  explicit VaryingPattern(std::uint64_t repeats) : repeats_(repeats) {}
  Time period() const override { return std::chrono::milliseconds(100); }
  std::size_t beams_per_scan() const override { return 16; }
  std::uint64_t repeats_after() const override { return repeats_; }
  void beams(std::uint64_t index, std::vector<Beam>& out) const override {
    out.assign(16, Beam{Eigen::Vector3f::UnitX(), 0, 0, Eigen::Vector3f::Zero()});
    const std::uint64_t phase = repeats_ == 0 ? index : index % repeats_;
    for (Beam& beam : out) beam.dt_ns = static_cast<std::int32_t>(phase);
  }

 private:
  std::uint64_t repeats_;
};

TEST(BeamTable, KeepsNothingOfPatternsThatDoNotRepeatAndAsksAgainWhereTimesDiffer) {
  for (const std::uint64_t repeats : {0U, 5U}) {
    const VaryingPattern pattern(repeats);
    const BeamTable table(pattern);
    std::vector<Beam> storage, expected;
    for (const std::uint64_t index : {3U, 4U, 8U, 3U}) {
      pattern.beams(index, expected);
      EXPECT_TRUE(same_beams(table.beams(index, storage), expected)) << repeats << " " << index;
    }
  }
}

}  // namespace
}  // namespace lidarena::sensor
