// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/livox.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <numbers>
#include <sstream>
#include <string>

#include "lidarena/base/error.hpp"
#include "tests/sensor/flights.hpp"

namespace lidarena::sensor {
namespace {

using testing::degrees;

constexpr std::uint64_t kMid360RepeatRows = 2'400'000;

struct Vector {
  std::string model;
  std::uint64_t row;
  Eigen::Vector3d direction;
};

std::vector<Vector> read_vectors() {
  std::ifstream in(LIDARENA_SOURCE_DIR "/tests/sensor/livox_vectors.csv");
  std::vector<Vector> vectors;
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream fields(line);
    Vector v;
    fields >> v.model >> v.row >> v.direction.x() >> v.direction.y() >> v.direction.z();
    vectors.push_back(v);
  }
  return vectors;
}

TEST(Livox, ReproducesTheReferenceRaysOfAllThreeModels) {
  const std::map<std::string, LivoxModel> models{{"livox_mid360", livox_mid360()},
                                                 {"livox_mid40", livox_mid40()},
                                                 {"livox_mid70", livox_mid70()}};
  const auto vectors = read_vectors();
  ASSERT_EQ(vectors.size(), 30U);
  for (const Vector& v : vectors) {
    const Eigen::Vector3d ray = livox_direction(models.at(v.model), v.row);
    // The file has nine decimals.
    EXPECT_LT((ray - v.direction).cwiseAbs().maxCoeff(), 1e-9) << v.model << " row " << v.row;
    EXPECT_NEAR(ray.norm(), 1.0, 1e-14);
  }
}

TEST(Livox, AScanOfTheMid360Is20000RowsFiveMicrosecondsApart) {
  const LivoxPattern pattern(livox_mid360(), 10.0, "test");
  EXPECT_EQ(pattern.period(), std::chrono::milliseconds(100));
  ASSERT_EQ(pattern.beams_per_scan(), 20'000U);
  std::vector<Beam> beams;
  const LivoxModel model = livox_mid360();
  for (const std::uint64_t scan : {7U, 0U, 119U}) {  // any order: a scan depends only on its index
    pattern.beams(scan, beams);
    ASSERT_EQ(beams.size(), 20'000U);
    for (std::size_t i = 0; i < beams.size(); ++i) {
      const Eigen::Vector3d ray = livox_direction(model, 20'000 * scan + i);
      EXPECT_EQ(beams[i].dt_ns, static_cast<std::int32_t>(5000 * i));
      EXPECT_EQ(beams[i].ring, i % 4);
      EXPECT_LT((beams[i].direction.cast<double>() - ray).norm(), 1e-7);  // single precision
      EXPECT_TRUE(beams[i].origin.isZero());
    }
  }
}

TEST(Livox, TheMid360PatternReturnsAfterTwelveSecondsAndNotAfterFour) {
  const LivoxModel model = livox_mid360();
  double after_12 = 0.0;
  double after_4 = 0.0;
  for (std::uint64_t row = 0; row < kMid360RepeatRows; row += 97) {
    const Eigen::Vector3d ray = livox_direction(model, row);
    after_12 = std::max(after_12, (livox_direction(model, row + kMid360RepeatRows) - ray).norm());
    after_4 = std::max(after_4, (livox_direction(model, row + 800'000) - ray).norm());
  }
  // Phases near 1e6 deg in double precision are good to 1e-10 deg.
  EXPECT_LT(degrees(after_12), 1e-9);
  EXPECT_GT(degrees(after_4), 30.0);

  const LivoxPattern pattern(livox_mid360(), 10.0, "test");
  std::vector<Beam> first;
  std::vector<Beam> later;
  pattern.beams(3, first);
  pattern.beams(3 + 120 * 1'000'000ULL, later);  // months later, bit for bit
  for (std::size_t i = 0; i < first.size(); ++i) {
    ASSERT_EQ(first[i].direction, later[i].direction);
  }
}

TEST(Livox, OverTheFourSecondsOfTheTableTheMid360SeesFromMinus7p2To52p2Degrees) {
  const LivoxModel model = livox_mid360();
  double low = 90.0;
  double high = -90.0;
  for (std::uint64_t row = 0; row < 800'000; ++row) {
    const double elevation = degrees(std::asin(livox_direction(model, row).z()));
    low = std::min(low, elevation);
    high = std::max(high, elevation);
  }
  EXPECT_NEAR(low, -7.2123, 5e-5);  // figures given to four decimals
  EXPECT_NEAR(high, 52.1641, 5e-5);
}

TEST(Livox, TheMid40AndMid70SeeTheirCirclesAndRepeatAfterThirtySeconds) {
  for (const auto& [model, half_fov] :
       {std::pair{livox_mid40(), 19.1728}, std::pair{livox_mid70(), 35.2158}}) {
    double widest = 0.0;
    double repeat_error = 0.0;
    for (std::uint64_t row = 0; row < 3'000'000; row += 3) {
      const Eigen::Vector3d ray = livox_direction(model, row);
      widest = std::max(widest, degrees(std::acos(ray.x())));
      if (row % 999 != 0) continue;
      repeat_error = std::max(repeat_error, (livox_direction(model, row + 3'000'000) - ray).norm());
    }
    EXPECT_NEAR(widest, half_fov, 1e-4);
    EXPECT_LT(repeat_error, 1e-10);
    EXPECT_EQ(LivoxPattern(model, 10.0, "test").beams_per_scan(), 10'000U);
  }
}

TEST(Livox, TheAviaSpansTheFieldOfViewOfItsDataSheet) {
  const LivoxModel model = livox_avia();
  double low = 0.0, high = 0.0, left = 0.0, right = 0.0;
  for (std::uint64_t row = 0; row < 240'000; ++row) {  // one second
    const Eigen::Vector3d ray = livox_direction(model, row);
    ASSERT_NEAR(ray.norm(), 1.0, 1e-12);  // no total reflection
    const double elevation = degrees(std::asin(ray.z()));
    const double aside = degrees(std::asin(ray.y()));  // from the vertical plane through x
    low = std::min(low, elevation);
    high = std::max(high, elevation);
    right = std::min(right, aside);
    left = std::max(left, aside);
  }
  EXPECT_NEAR(high - low, 77.06, 0.01);    // sheet: 77.2
  EXPECT_NEAR(left - right, 70.49, 0.01);  // sheet: 70.4
}

TEST(Livox, AScanOfTheAviaIs24000RowsEvenlySpreadOver100Milliseconds) {
  const LivoxPattern pattern(livox_avia(), 10.0, "test");
  std::vector<Beam> beams;
  pattern.beams(4, beams);
  ASSERT_EQ(beams.size(), 24'000U);
  for (std::size_t i = 0; i < beams.size(); ++i) {
    ASSERT_NEAR(beams[i].dt_ns, 1e9 * static_cast<double>(i) / 240'000.0, 0.5);
    ASSERT_EQ(beams[i].ring, i % 6);
  }
}

TEST(Livox, RejectsARateThatCutsALaserGroup) {
  EXPECT_NO_THROW(LivoxPattern(livox_mid360(), 20.0, "test"));
  EXPECT_THROW(LivoxPattern(livox_mid360(), 30.0, "test"), InputError);       // 6666.7 rows
  EXPECT_THROW(LivoxPattern(livox_mid360(), 32'000.0, "test"), InputError);   // 6.25 rows
  EXPECT_THROW(LivoxPattern(livox_mid360(), 100'000.0, "test"), InputError);  // half a group
}

}  // namespace
}  // namespace lidarena::sensor
