// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/signal_model.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "lidarena/base/error.hpp"

namespace lidarena::sensor {
namespace {

using ::testing::HasSubstr;

SignalConfig mid360_sheet() { return {.range_at_10_m = 40.0, .range_at_80_m = 70.0}; }

std::string returns_failure(const NoiseConfig& noise, const ReturnConfig& returns = {}) {
  try {
    check_returns(noise, returns, "sheet.yaml");
  } catch (const InputError& error) {
    return error.what();
  }
  return "no failure";
}

TEST(SignalModel, ATargetAtItsRatedRangeIsSeenAsOftenAsTheSheetSays) {
  for (const double detection : {0.5, 0.9, 0.99}) {
    SignalConfig sheet = mid360_sheet();
    sheet.detection = detection;
    const SignalModel model(sheet);
    EXPECT_NEAR(model.signal(0.1, 40.0), 1.0, 1e-12);
    EXPECT_NEAR(model.signal(0.8, 70.0), 1.0, 1e-12);
    EXPECT_NEAR(model.detection_probability(1.0), detection, 1e-9);
    EXPECT_NEAR(model.detection_probability(0.0), sheet.false_alarms, 1e-12);
  }
}

TEST(SignalModel, StrongSignalsAreSeenForCertain) {
  EXPECT_EQ(normal_cdf(8.3), 1.0);  // assumed by the shortcut for strong signals
  const SignalModel model(mid360_sheet());
  EXPECT_EQ(model.detection_probability(1e3), 1.0);
  double last = 0.0;
  for (double signal = 0.0; signal < 4.0; signal += 0.01) {
    EXPECT_GE(model.detection_probability(signal), last);
    last = model.detection_probability(signal);
  }
  EXPECT_EQ(last, 1.0);
}

TEST(SignalModel, WithoutASheetTheSignalFallsWithTheSquareOfTheRange) {
  const SignalModel model{SignalConfig{}};
  EXPECT_EQ(model.extinction(), 0.0);
  EXPECT_NEAR(model.signal(0.5, 3.0) / model.signal(0.5, 6.0), 4.0, 1e-12);
}

TEST(SignalModel, TheSignalFallsWithRangeWhateverTheSheet) {
  for (const double far : {45.0, 70.0, 113.0, 200.0, 240.0}) {
    const SignalModel model({.range_at_10_m = 40.0, .range_at_80_m = far});
    EXPECT_NEAR(model.signal(0.1, 40.0), 1.0, 1e-12);
    EXPECT_NEAR(model.signal(0.8, far), 1.0, 1e-12);
    for (double range = 1.0; range < far; range += 1.0) {
      EXPECT_GT(model.signal(0.5, range), model.signal(0.5, range + 1.0)) << far << " " << range;
    }
  }
}

TEST(SignalModel, DetectionFallsWithRangeAndIncidenceAndRisesWithReflectivity) {
  const SignalModel model(mid360_sheet());
  double last = 1.0;
  for (double range = 20.0; range <= 80.0; range += 1.0) {
    const double p = model.detection_probability(model.signal(0.1, range));
    EXPECT_LE(p, last);
    last = p;
  }
  EXPECT_LT(last, 0.01);
  EXPECT_GT(model.detection_probability(model.signal(0.8, 60.0)), 0.99);
  EXPECT_LT(model.detection_probability(model.signal(0.8 * std::cos(1.4), 60.0)), 0.2);
}

TEST(SignalModel, QuantilesInvertTheNormalDistribution) {
  EXPECT_NEAR(normal_cdf(1.959963984540054), 0.975, 1e-12);
  for (const double p : {1e-9, 1e-4, 0.3, 0.5, 0.9, 0.9999}) {
    EXPECT_NEAR(normal_cdf(normal_quantile(p)), p, 1e-12);
  }
}

TEST(RangeSigma, IsTheSheetsNearMiddleAndFar) {
  NoiseConfig noise;
  EXPECT_EQ(range_sigma(0.02, noise, 0.1, 1e-3), 0.02);  // constant unless more is configured
  noise.near_range_noise_m = 0.03;
  noise.weak_signal_noise = true;
  EXPECT_DOUBLE_EQ(range_sigma(0.02, noise, 0.1, 5.0), 0.03);
  EXPECT_DOUBLE_EQ(range_sigma(0.02, noise, 0.2, 5.0), 0.03);
  EXPECT_DOUBLE_EQ(range_sigma(0.02, noise, 0.6, 5.0), 0.025);
  EXPECT_DOUBLE_EQ(range_sigma(0.02, noise, 1.0, 5.0), 0.02);
  EXPECT_DOUBLE_EQ(range_sigma(0.02, noise, 10.0, 1.0), 0.02);
  EXPECT_DOUBLE_EQ(range_sigma(0.02, noise, 45.0, 0.25), 0.04);
}

TEST(ReturnConfig, PartsThatDoNotFitTogetherAreRefusedWithTheRemedy) {
  EXPECT_EQ(returns_failure({}), "no failure");
  NoiseConfig noise;
  noise.dropouts = true;
  EXPECT_THAT(returns_failure(noise), AllOf(HasSubstr("sheet.yaml"), HasSubstr("range_at_10_m")));
  noise.signal = {.range_at_10_m = 40.0, .range_at_80_m = 40.0};
  EXPECT_THAT(returns_failure(noise), HasSubstr("not above range_at_10_m"));
  noise.signal.range_at_80_m = 241.0;
  EXPECT_THAT(returns_failure(noise), HasSubstr("six times"));
  noise.signal = {
      .range_at_10_m = 40.0, .range_at_80_m = 70.0, .detection = 0.05, .false_alarms = 0.1};
  EXPECT_THAT(returns_failure(noise), HasSubstr("false_alarms"));
  noise = {};
  noise.near_range_noise_m = 0.03;
  noise.near_until_m = 0.1;
  EXPECT_THAT(returns_failure(noise), HasSubstr("near_until_m"));
  noise = {};
  noise.beam.sub_rays = 7;
  EXPECT_THAT(returns_failure(noise), HasSubstr("width_deg"));
  ReturnConfig two;
  two.count = 2;
  EXPECT_THAT(returns_failure({}, two), HasSubstr("sub_rays"));
}

}  // namespace
}  // namespace lidarena::sensor
