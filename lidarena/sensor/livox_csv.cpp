// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/livox_csv.hpp"

#include <array>
#include <cmath>
#include <fstream>
#include <numbers>
#include <numeric>
#include <optional>
#include <string_view>
#include <utility>

#include "lidarena/base/angle.hpp"
#include "lidarena/base/error.hpp"
#include "lidarena/base/number.hpp"
#include "lidarena/sensor/livox.hpp"

namespace lidarena::sensor {
namespace {

using Row = std::array<double, 3>;

std::optional<double> number(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return std::nullopt;
  return parse_number(text.substr(first, text.find_last_not_of(" \t") - first + 1));
}

/// Three comma-separated numbers; nullopt for any other line.
std::optional<Row> parse(std::string_view line) {
  Row row;
  for (std::size_t column = 0; column < 3; ++column) {
    const auto comma = line.find(',');
    if ((comma == std::string_view::npos) != (column == 2)) return std::nullopt;
    const auto value = number(line.substr(0, comma));
    if (!value) return std::nullopt;
    row[column] = *value;
    line.remove_prefix(column == 2 ? line.size() : comma + 1);
  }
  return row;
}

Eigen::Vector3f direction(const Row& row, const std::string& place) {
  const auto [time, azimuth, zenith] = row;
  if (!std::isfinite(time) || !(std::abs(azimuth) <= 360.0) ||
      !(zenith >= 0.0 && zenith <= 180.0)) {
    throw InputError(place, "an angle is out of range or not finite",
                     "azimuth must be within +-360 deg, the zenith angle within 0..180 deg");
  }
  const double a = azimuth * kDegree;
  const double z = zenith * kDegree;
  return Eigen::Vector3d(std::sin(z) * std::cos(a), std::sin(z) * std::sin(a), std::cos(z))
      .cast<float>();
}

}  // namespace

std::vector<Eigen::Vector3f> read_livox_csv(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) throw InputError(file.string(), "cannot be opened", "check pattern_file");
  std::vector<Eigen::Vector3f> rays;
  std::size_t line_number = 0;
  for (std::string line; std::getline(in, line);) {
    ++line_number;
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.find_first_not_of(" \t") == std::string::npos) continue;
    const std::string place = file.string() + ":" + std::to_string(line_number);
    const auto row = parse(line);
    if (row) {
      rays.push_back(direction(*row, place));
    } else if (line_number > 1 || number(line.substr(0, line.find(',')))) {
      throw InputError(place, "is not a row of three numbers",
                       "write index or time, azimuth in deg, zenith angle in deg");
    }
  }
  if (rays.empty()) throw InputError(file.string(), "has no rows");
  return rays;
}

RayTablePattern::RayTablePattern(std::vector<Eigen::Vector3f> rays, double row_rate_hz, int lines,
                                 double rate_hz, const std::string& name)
    : rays_(std::move(rays)),
      row_rate_hz_(row_rate_hz),
      lines_(static_cast<std::uint64_t>(lines)),
      period_(from_seconds(1.0 / rate_hz)),
      rows_per_scan_(rows_per_scan(row_rate_hz, rate_hz, 1, name)) {
  if (rays_.empty()) throw InputError(name, "the pattern has no rows");
}

std::uint64_t RayTablePattern::repeats_after() const {
  const std::uint64_t rays = rays_.size();
  return rays / std::gcd(rays, static_cast<std::uint64_t>(rows_per_scan_));
}

void RayTablePattern::beams(std::uint64_t index, std::vector<Beam>& out) const {
  out.resize(rows_per_scan_);
  for (std::size_t i = 0; i < rows_per_scan_; ++i) {
    const std::uint64_t row = (index * rows_per_scan_ + i) % rays_.size();
    out[i] = {.direction = rays_[row],
              .dt_ns = row_dt_ns(i, row_rate_hz_),
              .ring = static_cast<std::uint16_t>(row % lines_),
              .origin = Eigen::Vector3f::Zero()};
  }
}

}  // namespace lidarena::sensor
