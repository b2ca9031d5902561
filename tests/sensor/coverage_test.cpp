// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/coverage.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>

#include "lidarena/sensor/livox.hpp"
#include "tests/sensor/flights.hpp"

namespace lidarena::sensor {
namespace {

std::vector<Time> seconds(std::initializer_list<double> instants) {
  std::vector<Time> times;
  for (const double t : instants) times.push_back(from_seconds(t));
  return times;
}

/// Fires once along each of `directions`, 10 ms apart, and repeats.
class FewRays : public ScanPattern {
 public:
  explicit FewRays(std::vector<Eigen::Vector3f> directions) : directions_(std::move(directions)) {}
  Time period() const override { return std::chrono::milliseconds(10) * directions_.size(); }
  std::size_t beams_per_scan() const override { return directions_.size(); }
  void beams(std::uint64_t, std::vector<Beam>& out) const override {
    out.clear();
    for (const auto& d : directions_) {
      out.push_back({d, static_cast<std::int32_t>(10'000'000 * out.size()), 0, {0, 0, 0}});
    }
  }

 private:
  std::vector<Eigen::Vector3f> directions_;
};

Eigen::Vector3f ray(double azimuth_deg, double elevation_deg) {
  const double a = testing::radians(azimuth_deg);
  const double e = testing::radians(elevation_deg);
  return Eigen::Vector3d(std::cos(a) * std::cos(e), std::sin(a) * std::cos(e), std::sin(e))
      .cast<float>();
}

TEST(Coverage, IsTheSolidAngleOfTheCellsThatWereHit) {
  const FieldOfView fov{-180, 180, -30, 30};
  // Four columns of 90 deg, two rows of equal solid angle: each cell is an eighth.
  const FewRays pattern({ray(45, 10), ray(50, 20), ray(-45, 10), ray(45, -10), ray(10, 40)});
  const auto shares = coverage(pattern, {-180, 180, -90, 90}, 90.0,
                               seconds({0.0, 0.005, 0.015, 0.025, 0.035, 0.045, 1.0}));
  const std::vector<double> eighths{0, 1, 1, 2, 3, 3, 3};
  ASSERT_EQ(shares.size(), eighths.size());
  for (std::size_t i = 0; i < shares.size(); ++i) EXPECT_NEAR(shares[i], eighths[i] / 8, 1e-12);

  // Rows farther from the equator have a smaller solid angle; rays outside do not count.
  const auto of_rows = coverage(FewRays({ray(7, 29), ray(7, 31)}), fov, 20.0, seconds({1.0}));
  const double row = std::sin(testing::radians(30)) - std::sin(testing::radians(10));
  EXPECT_NEAR(of_rows[0], row / 18 / (2 * std::sin(testing::radians(30))), 1e-12);
}

TEST(Coverage, InAConeCountsTheCellsWhoseCenterLiesInIt) {
  // The centers of all four cells are less than 8 deg off the axis.
  const FieldOfView fov{-10, 10, -10, 10, 8.0};
  EXPECT_NEAR(coverage(FewRays({ray(1, 1)}), fov, 10.0, seconds({1.0}))[0], 0.25, 1e-12);
  const FieldOfView narrow{-15, 15, -15, 15, 8.0};  // of nine cells only the central one
  EXPECT_NEAR(coverage(FewRays({ray(1, 1)}), narrow, 10.0, seconds({1.0}))[0], 1.0, 1e-12);
  EXPECT_NEAR(coverage(FewRays({ray(9, 1)}), narrow, 10.0, seconds({1.0}))[0], 0.0, 1e-12);
}

TEST(Coverage, OfTheMid360IsThatOfTheMakersTable) {
  const LivoxPattern pattern(livox_mid360(), 10.0, "test");
  const FieldOfView fov{-180, 180, -7, 52};
  const auto instants = seconds({0.1, 0.2, 0.5, 1, 2, 4, 12});
  const std::map<double, std::array<double, 7>> expected{
      {1.0, {0.638, 0.829, 0.968, 0.975, 0.975, 0.976, 0.976}},
      {0.5, {0.215, 0.377, 0.665, 0.838, 0.952, 0.969, 0.971}},
      {0.25, {0.058, 0.112, 0.253, 0.428, 0.677, 0.881, 0.968}},
      {0.2, {0.038, 0.074, 0.173, 0.313, 0.534, 0.777, 0.964}},
      {0.1, {0.010, 0.019, 0.047, 0.091, 0.175, 0.318, 0.683}}};
  std::map<double, Coverage> grids;
  for (const auto& [cell, shares] : expected) grids.emplace(cell, Coverage(fov, cell));
  Shots shots(pattern);
  for (std::size_t i = 0; i < instants.size(); ++i) {
    for (; shots.time() < instants[i]; shots.advance()) {
      for (auto& [cell, grid] : grids) grid.add(shots.beam().direction);
    }
    for (const auto& [cell, grid] : grids) {
      // half a unit of the third decimal, plus the cells that change due to single precision
      EXPECT_NEAR(grid.share(), expected.at(cell)[i], 6e-4) << cell << " deg";
    }
  }
}

TEST(Coverage, OfTheMid40AndMid70IsThatOfTheMakersTables) {
  const auto instants = seconds({0.1, 0.5, 1, 4});
  struct Row {
    LivoxModel model;
    double half_fov_deg, cell_deg;
    std::array<double, 4> shares;
  };
  for (const Row& row : {Row{livox_mid40(), 19.173, 0.5, {0.351, 0.938, 0.997, 1.000}},
                         Row{livox_mid40(), 19.173, 0.25, {0.182, 0.665, 0.912, 1.000}},
                         Row{livox_mid70(), 35.216, 0.5, {0.194, 0.683, 0.923, 1.000}},
                         Row{livox_mid70(), 35.216, 0.25, {0.093, 0.390, 0.644, 0.993}}}) {
    const LivoxPattern pattern(row.model, 10.0, "test");
    // The reference does not say how its cells are placed. With one cell centered on the axis all
    // 16 figures agree; shifted by half a cell they differ by up to 0.004.
    const double edge = 40.0 + row.cell_deg / 2;
    const FieldOfView fov{-edge, edge, -edge, edge, row.half_fov_deg};
    const auto found = coverage(pattern, fov, row.cell_deg, instants);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(found[i], row.shares[i], 0.001);
  }
}

TEST(Coverage, OfARingOnABorderBetweenCellsIsThatOfOneRow) {
  std::vector<Eigen::Vector3f> ring;
  for (double azimuth = -179.75; azimuth < 180.0; azimuth += 0.5) ring.push_back(ray(azimuth, 3.0));
  const auto share = coverage(FewRays(ring), {-180, 180, -15, 15}, 0.5, seconds({100.0}))[0];
  const double strip = std::sin(testing::radians(3.5)) - std::sin(testing::radians(3.0));
  EXPECT_NEAR(share, strip / (2 * std::sin(testing::radians(15))), 1e-12);
}

TEST(Coverage, WithoutADataSheetTheFieldOfViewIsTheBoxAroundTheShots) {
  const FewRays pattern({ray(-20.5, 3.2), ray(10.1, -4.9), ray(90, 90)});
  const FieldOfView fov = observed_field_of_view(pattern, from_seconds(0.015));
  EXPECT_EQ(fov.azimuth_min_deg, -21);
  EXPECT_EQ(fov.azimuth_max_deg, 11);
  EXPECT_EQ(fov.elevation_min_deg, -5);
  EXPECT_EQ(fov.elevation_max_deg, 4);
}

TEST(Shots, FollowEachOtherThroughTheScans) {
  const LivoxPattern pattern(livox_mid40(), 100.0, "test");  // 1000 rows a scan
  Shots shots(pattern);
  for (std::uint64_t row = 0; row < 3500; ++row, shots.advance()) {
    ASSERT_EQ(shots.time(), Time{static_cast<std::int64_t>(10'000 * row)});
    ASSERT_LT((shots.beam().direction.cast<double>() - livox_direction(livox_mid40(), row)).norm(),
              1e-7);
  }
}

}  // namespace
}  // namespace lidarena::sensor
