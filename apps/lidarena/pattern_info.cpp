// SPDX-License-Identifier: BSD-3-Clause
#include "apps/lidarena/pattern_info.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "apps/lidarena/cell_chart.hpp"
#include "lidarena/base/angle.hpp"
#include "lidarena/dataset/part_file.hpp"
#include "lidarena/sensor/coverage.hpp"

namespace lidarena {
namespace {

constexpr double kTimes[] = {0.1, 0.5, 1.0, 4.0};  // s

/// Cell size in degrees: finer for narrow fields of view.
double cell_of(const sensor::FieldOfView& fov) {
  return fov.azimuth_max_deg - fov.azimuth_min_deg > 180.0 ? 0.5 : 0.25;
}

sensor::FieldOfView fov_of(const sensor::SensorConfig& sensor, const sensor::ScanPattern& pattern) {
  const auto stated = sensor::field_of_view(sensor);
  return stated ? *stated : sensor::observed_field_of_view(pattern, from_seconds(1.0));
}

/// The drawn area: the bounding box of the field of view and ten cells around it.
sensor::FieldOfView margin_around(const sensor::FieldOfView& fov, double cell_deg) {
  const double margin = 10 * cell_deg;
  return {std::max(-180.0, fov.azimuth_min_deg - margin),
          std::min(180.0, fov.azimuth_max_deg + margin),
          std::max(-90.0, fov.elevation_min_deg - margin),
          std::min(90.0, fov.elevation_max_deg + margin)};
}

std::vector<std::pair<double, double>> outline_of(const sensor::FieldOfView& fov) {
  if (fov.half_angle_deg >= 90.0) {
    return {{fov.azimuth_min_deg, fov.elevation_min_deg},
            {fov.azimuth_max_deg, fov.elevation_min_deg},
            {fov.azimuth_max_deg, fov.elevation_max_deg},
            {fov.azimuth_min_deg, fov.elevation_max_deg}};
  }
  std::vector<std::pair<double, double>> circle;
  const double half = fov.half_angle_deg * kDegree;
  for (int degree = 0; degree < 360; degree += 3) {
    const double y = std::sin(half) * std::cos(degree * kDegree);
    const double z = std::sin(half) * std::sin(degree * kDegree);
    circle.emplace_back(std::atan2(y, std::cos(half)) / kDegree, std::asin(z) / kDegree);
  }
  return circle;
}

CellPanel panel_of(const sensor::Coverage& grid, double seconds, double share) {
  CellPanel panel;
  panel.title = fmt::format("{:g} s: {:.1f} % covered", seconds, 100.0 * share);
  for (int row = 0; row < grid.rows(); ++row) {
    for (int column = 0; column < grid.columns(); ++column) {
      panel.lit.push_back(grid.lit(column, row));
    }
  }
  return panel;
}

}  // namespace

void print_rays(const sensor::SensorConfig& sensor, std::size_t count) {
  const auto pattern = sensor::make_pattern(sensor);
  sensor::Shots shots(*pattern);
  fmt::print("index,dt_ns,x,y,z,ring\n");
  for (std::size_t i = 0; i < count; ++i, shots.advance()) {
    const sensor::Beam& b = shots.beam();
    fmt::print("{},{},{:.9g},{:.9g},{:.9g},{}\n", i, shots.time().count(), b.direction.x(),
               b.direction.y(), b.direction.z(), b.ring);
  }
}

Json pattern_info(const sensor::SensorConfig& sensor, const std::filesystem::path& svg) {
  const auto pattern = sensor::make_pattern(sensor);
  const sensor::FieldOfView fov = fov_of(sensor, *pattern);
  const double cell_deg = cell_of(fov);
  const sensor::FieldOfView view = margin_around(fov, cell_deg);
  sensor::Coverage inside(fov, cell_deg);
  sensor::Coverage drawn(view, cell_deg);
  CellChart chart{
      .title = sensor.name,
      .caption = fmt::format("cells of {:g} deg with at least one shot; share of the field "
                             "of view's solid angle",
                             cell_deg),
      .azimuth_min_deg = view.azimuth_min_deg,
      .elevation_min_deg = view.elevation_min_deg,
      .cell_deg = cell_deg,
      .columns = drawn.columns(),
      .rows = drawn.rows(),
      .panels = {},
      .outline = outline_of(fov),
      .outline_label =
          sensor.facts.fov ? "field of view of the data sheet" : "field of view of the shots"};
  if (!sensor.facts.approximate.empty())
    chart.caption += ". Approximate: " + sensor.facts.approximate;

  Json json{{"kind", "pattern"},
            {"sensor", sensor.name},
            {"fov", to_json(fov)},
            {"fov_from", sensor.facts.fov ? "data sheet" : "the shots of the first second"},
            {"cell_deg", cell_deg},
            {"coverage", Json::object()}};
  if (!sensor.facts.approximate.empty()) json["approximate"] = sensor.facts.approximate;
  sensor::Shots shots(*pattern);
  for (const double seconds : kTimes) {
    for (; shots.time() < from_seconds(seconds); shots.advance()) {
      inside.add(shots.beam().direction);
      drawn.add(shots.beam().direction);
    }
    json["coverage"][fmt::format("{:g} s", seconds)] = inside.share();
    chart.panels.push_back(panel_of(drawn, seconds, inside.share()));
  }
  if (!svg.empty()) {
    dataset::PartFile out(svg);
    out.write(cell_chart_svg(chart));
    out.commit();
    json["drawing"] = svg.string();
  }
  return json;
}

}  // namespace lidarena
