// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/livox_csv.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <fstream>
#include <initializer_list>
#include <numbers>
#include <numeric>
#include <optional>
#include <sstream>
#include <string>
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

/// What the columns of the two angles hold, by the header.
struct AngleColumns {
  std::size_t azimuth = 1;
  std::size_t polar = 2;
  double azimuth_unit = kDegree;  ///< in rad
  double polar_unit = kDegree;
  bool polar_is_elevation = false;  ///< from the xy plane upwards; else from z downwards
};

/// The unit that a column's name states, in rad. Throws InputError where it states none.
double unit_of(const std::string& name, const std::string& place) {
  if (name.find("deg") != std::string::npos) return kDegree;
  if (name.find("rad") != std::string::npos) return 1.0;
  throw InputError(place, "the column '" + name + "' states no unit",
                   "name the columns with units, as Time/s,Azimuth/deg,Zenith/deg");
}

/// Throws InputError unless the line names three columns, two of them an azimuth and a zenith angle
/// (or elevation) with their units.
AngleColumns angles_of(std::string header, const std::string& place) {
  std::ranges::transform(header, header.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  std::array<std::string, 3> names;
  std::istringstream columns(header);
  for (std::string& name : names) std::getline(columns, name, ',');
  const auto find = [&](std::initializer_list<const char*> words) -> std::optional<std::size_t> {
    for (std::size_t i = 0; i < names.size(); ++i) {
      for (const char* word : words)
        if (names[i].find(word) != std::string::npos) return i;
    }
    return std::nullopt;
  };
  const auto azimuth = find({"azimuth"});
  const auto zenith = find({"zenith"});
  const auto elevation = find({"elevation", "altitude"});
  if (!azimuth || (!zenith && !elevation)) {
    throw InputError(place, "is not a header with an azimuth and a zenith angle",
                     "begin the table with Time/s,Azimuth/deg,Zenith/deg");
  }
  const std::size_t polar = zenith ? *zenith : *elevation;
  return {*azimuth, polar, unit_of(names[*azimuth], place), unit_of(names[polar], place), !zenith};
}

Eigen::Vector3f direction(const Row& row, const AngleColumns& angles, const std::string& place) {
  constexpr double kTurn = 2.0 * std::numbers::pi, kRounding = 1e-6;
  const double a = row[angles.azimuth] * angles.azimuth_unit;
  const double polar = row[angles.polar] * angles.polar_unit;
  const double z = angles.polar_is_elevation ? 0.5 * std::numbers::pi - polar : polar;
  const bool is_in_range =
      std::abs(a) <= kTurn + kRounding && z >= -1e-12 && z <= std::numbers::pi + kRounding;
  if (!std::ranges::all_of(row, [](double value) { return std::isfinite(value); }) ||
      !is_in_range) {
    throw InputError(place, "an angle is out of range or not finite",
                     "azimuth must be within +-360 deg, the zenith angle within 0..180 deg");
  }
  return Eigen::Vector3d(std::sin(z) * std::cos(a), std::sin(z) * std::sin(a), std::cos(z))
      .cast<float>();
}

}  // namespace

std::vector<Eigen::Vector3f> read_livox_csv(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) throw InputError(file.string(), "cannot be opened", "check pattern_file");
  std::vector<Eigen::Vector3f> rays;
  std::optional<AngleColumns> angles;
  std::size_t line_number = 0;
  for (std::string line; std::getline(in, line);) {
    ++line_number;
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.find_first_not_of(" \t") == std::string::npos) continue;
    const std::string place = file.string() + ":" + std::to_string(line_number);
    if (!angles) {
      angles = angles_of(line, place);
      continue;
    }
    const auto row = parse(line);
    if (!row) {
      throw InputError(place, "is not a row of three numbers",
                       "write index or time, azimuth, zenith angle, as the header says");
    }
    rays.push_back(direction(*row, *angles, place));
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
