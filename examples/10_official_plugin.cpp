// SPDX-License-Identifier: BSD-3-Clause
// Reproduces figure 3 of Vultaggio et al. 2023: a Livox Mid-360 on the axis of a cylinder,
// simulated as by the official Gazebo plugin (every range too short by the minimum range, so the
// wall appears to bulge) and correctly. Prints the measured radius in bands of elevation, beside
// the closed form R - m cos(phi) (R radius, m minimum range, phi elevation), and draws a cross
// section of both clouds. usage: example_10_official_plugin [FILE.svg]
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <numbers>
#include <string>

#include "lidarena/base/time.hpp"
#include "lidarena/sensor/lidar.hpp"
#include "lidarena/world/primitives.hpp"
#include "lidarena/world/world.hpp"

namespace {

using namespace lidarena;

constexpr double kRadius = 0.55;  // m, radius of the cylinder in the paper's experiment
constexpr double kHeight = 3.0;
constexpr double kMinRange = 0.1;  // m, of the Mid-360
constexpr double kDegree = std::numbers::pi / 180.0;
constexpr int kBandWidth = 10;  // deg of elevation
constexpr int kBands = 6;       // -10 .. 50 deg

/// A flight that stays at the origin.
class StaticFlight : public flight::Flight {
 public:
  flight::Motion at(Time) const override { return {}; }
  Time duration() const override { return std::chrono::seconds(1); }
};

Scan look_at_cylinder(const world::World& world, sensor::ScanMode mode) {
  sensor::SensorConfig config;
  config.name = "mid360";
  config.model = sensor::LidarModel::kLivoxMid360;
  config.min_range_m = kMinRange;
  config.mode = mode;
  const sensor::Lidar lidar(config, sensor::make_pattern(config), config.name, 1, false);
  return lidar.measure(world, StaticFlight(), 0, Parallel());
}

double radius(const Point& point) { return point.position.head<2>().norm(); }
double elevation(const Point& point) { return std::atan2(point.position.z(), radius(point)); }

/// Mean radius (m) and number of points of each band.
std::array<std::pair<double, int>, kBands> radii(const Scan& scan) {
  std::array<std::pair<double, int>, kBands> bands{};
  for (const Point& point : scan.points) {
    const int band = static_cast<int>(std::floor(elevation(point) / kDegree / kBandWidth)) + 1;
    if (band < 0 || band >= kBands) continue;
    auto& [mean, count] = bands[static_cast<std::size_t>(band)];
    ++count;
    mean += (radius(point) - mean) / count;
  }
  return bands;
}

/// Cross section of one cloud as SVG: radius to both sides, height up; the wall as lines.
std::string panel(const Scan& scan, const std::string& title, double x0) {
  constexpr double kScale = 190.0;  // pixels a meter
  const auto px = [&](double r) { return x0 + 160.0 + kScale * r; };
  const auto py = [](double z) { return 220.0 - kScale * z; };
  std::string svg = fmt::format(
      "<text x='{:.0f}' y='24' text-anchor='middle' font-size='15'>{}</text>\n", px(0), title);
  for (const double side : {-kRadius, kRadius}) {
    svg +=
        fmt::format("<line x1='{0:.1f}' x2='{0:.1f}' y1='{1:.1f}' y2='{2:.1f}' stroke='#888'/>\n",
                    px(side), py(-0.2), py(0.9));
  }
  std::string dots;
  for (std::size_t i = 0; i < scan.points.size(); i += 7) {
    const Point& point = scan.points[i];
    if (std::abs(point.position.z()) > 0.9) continue;
    const double side = point.position.y() < 0 ? -1.0 : 1.0;
    dots += fmt::format("M{:.1f} {:.1f}h0", px(side * radius(point)), py(point.position.z()));
  }
  svg += "<path d='" + dots + "' stroke='#2b6cb0' stroke-width='1.6' stroke-linecap='round'/>\n";
  svg += fmt::format("<circle cx='{:.1f}' cy='{:.1f}' r='4' fill='#c53030'/>\n", px(0), py(0));
  return svg;
}

void draw(const std::string& file, const Scan& official, const Scan& ours) {
  std::ofstream(file)
      << "<svg xmlns='http://www.w3.org/2000/svg' width='660' height='290' "
         "font-family='sans-serif' fill='#222'>\n"
      << "<rect width='660' height='290' fill='white'/>\n"
      << panel(official, "official plugin", 0) << panel(ours, "Lidarena", 330)
      << "<text x='330' y='280' text-anchor='middle' font-size='12'>a Mid-360 (red) "
         "in a cylinder of radius 0.55 m (gray), cross section</text>\n</svg>\n";
}

}  // namespace

int main(int argc, char** argv) {
  const world::World world(world::cylinder_shape(kRadius, kHeight), "cylinder");
  const Scan official = look_at_cylinder(world, sensor::ScanMode::kOfficial);
  const Scan ours = look_at_cylinder(world, sensor::ScanMode::kRolling);

  fmt::print("measured radius, m (true: {})\n", kRadius);
  fmt::print("elevation deg   official   R - m cos(phi)   Lidarena\n");
  bool as_expected = true;
  const auto official_radii = radii(official);
  const auto our_radii = radii(ours);
  for (int i = 0; i < kBands; ++i) {
    const auto band = static_cast<std::size_t>(i);
    const double low = (i - 1) * kBandWidth;
    // `official` shortens ranges along the ray, so points keep their elevation.
    const double expected = kRadius - kMinRange * std::cos((low + 0.5 * kBandWidth) * kDegree);
    fmt::print("{:4.0f} .. {:2.0f}       {:8.4f}   {:14.4f}   {:8.4f}\n", low, low + kBandWidth,
               official_radii[band].first, expected, our_radii[band].first);
    // Tolerances: facets lie up to 0.7 mm inside the circle; points are unevenly spread in a band.
    as_expected = as_expected && std::abs(official_radii[band].first - expected) < 0.008 &&
                  std::abs(our_radii[band].first - kRadius) < 0.0008;
  }
  if (argc > 1) {
    draw(argv[1], official, ours);
    fmt::print("picture: {}\n", argv[1]);
  }
  return as_expected ? 0 : 1;
}
