// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/report/top_view.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "lidarena/report/image.hpp"
#include "lidarena/report/svg.hpp"

namespace lidarena::report {
namespace {

constexpr int kMaxHeight = 900;
constexpr int kTitleHeight = 24;
constexpr double kMargin = 0.03;  // share of the picture left empty on each side
// Quantized to at most 256 colors, so that a noisy picture takes less than half of the bytes.
constexpr double kOpacities = 10.0;
constexpr double kDistanceStep_m = 0.01;

/// World x, y to pixels: x to the right, y upwards.
struct View {
  double x0, y1, pixels_per_m;
  int width, height;
  double px(double x) const { return (x - x0) * pixels_per_m; }
  double py(double y) const { return (y1 - y) * pixels_per_m; }
};

/// Box that contains 99.8 % of the points in each direction and the whole true path, so that a few
/// stray points of a bad map do not shrink the picture.
Eigen::AlignedBox2d framed(const TopView& view) {
  Eigen::AlignedBox2d box;
  if (view.truth != nullptr) {
    for (const StampedPose& p : view.truth->poses()) {
      box.extend(Eigen::Vector2d(p.world_from_body.translation().head<2>()));
    }
  }
  if (view.map != nullptr && !view.map->points.empty()) {
    Eigen::Vector2d low;
    Eigen::Vector2d high;
    for (int axis = 0; axis < 2; ++axis) {
      std::vector<float> values;
      for (const Eigen::Vector3f& p : view.map->points) {
        if (p.allFinite()) values.push_back(p[axis]);
      }
      if (values.empty()) return box;
      const std::size_t cut = values.size() / 1000;
      const auto at = [&](std::size_t i) {
        std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(i),
                         values.end());
        return static_cast<double>(values[i]);
      };
      low[axis] = at(cut);
      high[axis] = at(values.size() - 1 - cut);
    }
    box.extend(low);
    box.extend(high);
  }
  return box;
}

View fit(const Eigen::AlignedBox2d& box, int width) {
  const Eigen::Vector2d size = box.sizes().cwiseMax(1.0) * (1.0 + 2.0 * kMargin);
  const double scale = std::min(width / size.x(), kMaxHeight / size.y());
  const Eigen::Vector2d center = box.center();
  View view{};
  view.width = width;
  view.height = static_cast<int>(std::ceil(size.y() * scale));
  view.pixels_per_m = scale;
  view.x0 = center.x() - 0.5 * width / scale;
  view.y1 = center.y() + 0.5 * view.height / scale;
  return view;
}

/// Counts the points and averages their distances per pixel; opacity grows with the log of the
/// count.
Image xray(const dataset::Cloud& map, const View& view) {
  const auto cells = static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height);
  std::vector<float> count(cells, 0.0F);
  std::vector<float> sum(cells, 0.0F);
  for (std::size_t i = 0; i < map.points.size(); ++i) {
    const Eigen::Vector3f& p = map.points[i];
    const double x = view.px(p.x());
    const double y = view.py(p.y());
    if (!(x >= 0 && x < view.width && y >= 0 && y < view.height)) continue;
    const std::size_t cell = static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width) +
                             static_cast<std::size_t>(x);
    count[cell] += 1.0F;
    sum[cell] += map.distance.empty() ? 0.0F : std::min(map.distance[i], 1.0F);
  }
  std::vector<float> filled;
  for (const float c : count) {
    if (c > 0) filled.push_back(c);
  }
  float full = 1.0F;  // count that gives full opacity: the 97th percentile
  if (!filled.empty()) {
    const auto nth = filled.begin() + static_cast<std::ptrdiff_t>(filled.size() * 97 / 100);
    std::nth_element(filled.begin(), nth, filled.end());
    full = *nth;
  }
  Image image(view.width, view.height, {255, 255, 255});
  for (std::size_t i = 0; i < cells; ++i) {
    if (count[i] <= 0) continue;
    const double fill = std::min(1.0, 0.15 + 0.85 * std::log1p(count[i]) / std::log1p(full));
    const double opacity = std::round(kOpacities * fill) / kOpacities;
    const double mean_m = static_cast<double>(sum[i]) / count[i];
    const Rgb color = distance_color(std::round(mean_m / kDistanceStep_m) * kDistanceStep_m);
    for (std::size_t c = 0; c < 3; ++c) {
      image.pixels[i][c] =
          static_cast<std::uint8_t>(std::lround(255.0 + opacity * (color[c] - 255.0)));
    }
  }
  return image;
}

/// A polyline in pixels; points closer than half a pixel to the last drawn one are skipped.
template <class Positions>
std::string polyline(const View& view, const Positions& positions, const char* style) {
  std::string points;
  Eigen::Vector2d last(1e9, 1e9);
  for (const Eigen::Vector3d& p : positions) {
    const Eigen::Vector2d here(view.px(p.x()), view.py(p.y()));
    if ((here - last).norm() < 0.5) continue;
    points += fmt::format("{:.1f},{:.1f} ", here.x(), here.y());
    last = here;
  }
  return fmt::format("<polyline points='{}' fill='none' {}/>", points, style);
}

/// The largest of 1, 2, 5 times a power of ten that is at most `length`.
double nice_length(double length) {
  const double magnitude = std::pow(10.0, std::floor(std::log10(length)));
  for (const double factor : {5.0, 2.0}) {
    if (factor * magnitude <= length) return factor * magnitude;
  }
  return magnitude;
}

std::string scale_bar(const View& view) {
  const double length_m = nice_length(0.2 * view.width / view.pixels_per_m);
  const double x = 12;
  const double y = view.height - 12;
  return fmt::format(
      "<line x1='{0:.1f}' x2='{1:.1f}' y1='{2:.1f}' y2='{2:.1f}' stroke='#222' stroke-width='2'/>"
      "<text x='{0:.1f}' y='{3:.1f}' class='t' paint-order='stroke' stroke='#fff' "
      "stroke-width='3'>{4:g} m</text>",
      x, x + length_m * view.pixels_per_m, y, y - 5, length_m);
}

}  // namespace

std::string top_view_svg(const TopView& view) {
  const Eigen::AlignedBox2d box = framed(view);
  if (box.isEmpty()) {
    return fmt::format(
        "<svg xmlns='http://www.w3.org/2000/svg' width='{0}' height='{1}'><text x='8' y='15' "
        "class='h'>{2}: no map and no path to draw</text></svg>",
        view.width, kTitleHeight, escaped(view.title));
  }
  const View pixels = fit(box, view.width);
  std::string svg = fmt::format(
      "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {0} {1}' width='{0}' height='{1}' "
      "font-family='system-ui,sans-serif' font-size='12' role='img' aria-label='{2}'>"
      "<text x='8' y='15' class='h'>{2}</text><g transform='translate(0 {3})'>",
      pixels.width, pixels.height + kTitleHeight, escaped(view.title), kTitleHeight);
  if (view.map != nullptr && !view.map->points.empty()) {
    svg += fmt::format("<image width='{}' height='{}' href='data:image/png;base64,{}'/>",
                       pixels.width, pixels.height, base64(encode_png(xray(*view.map, pixels))));
  }
  if (view.truth != nullptr) {
    std::vector<Eigen::Vector3d> positions;
    for (const StampedPose& p : view.truth->poses()) {
      positions.push_back(p.world_from_body.translation());
    }
    svg += polyline(pixels, positions, "stroke='#5b6470' stroke-width='3' stroke-opacity='0.55'");
  }
  svg += polyline(pixels, view.estimate, "stroke='#f97316' stroke-width='1.4'");
  return svg + scale_bar(pixels) + "</g></svg>";
}

}  // namespace lidarena::report
