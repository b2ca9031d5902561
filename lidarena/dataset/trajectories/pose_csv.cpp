// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/trajectories/pose_csv.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/text_file.hpp"
#include "lidarena/dataset/trajectories/trajectory_rows.hpp"

namespace lidarena::dataset {
namespace {

/// The columns of a pose; position and quaternion in the order of kNumbers.
struct Columns {
  std::size_t time = 0;
  std::array<std::size_t, 7> numbers{};
  std::int64_t time_unit_ns = 0;  ///< 0: told by the magnitude
};
constexpr std::array kNumbers{"x", "y", "z", "qw", "qx", "qy", "qz"};

/// The words of a column's name in lower case: "q_RS_w []" has q, rs, w.
std::vector<std::string> words_of(std::string_view name) {
  std::vector<std::string> words{""};
  for (const char c : name.substr(0, name.find('['))) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) {
      words.back() += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    } else if (!words.back().empty()) {
      words.emplace_back();
    }
  }
  if (words.back().empty()) words.pop_back();
  return words;
}

template <std::size_t N>
bool has_any(const std::vector<std::string>& words, const std::array<const char*, N>& sought) {
  return std::ranges::any_of(words, [&](const std::string& word) {
    return std::ranges::find(sought, word) != sought.end();
  });
}

/// The member of a pose that a column holds ("x", "qw", ...); empty for other columns.
std::string member_of(std::string_view name) {
  const std::vector<std::string> words = words_of(name);
  static constexpr std::array kOthers{"v",    "vel",  "velocity", "twist", "linear",     "angular",
                                      "b",    "bias", "acc",      "accel", "covariance", "cov",
                                      "gyro", "std",  "sigma",    "euler", "w"};
  static constexpr std::array kRotations{"q",           "quat",     "quaternion",
                                         "orientation", "rotation", "rot"};
  static constexpr std::array kAxes{"x", "y", "z", "w"};
  if (words.empty()) return {};
  const std::string& last = words.back();
  const std::vector<std::string> before(words.begin(), words.end() - 1);
  const auto is_velocity = [](const std::string& word) {
    return word.find("vel") != std::string::npos;
  };
  if (has_any(before, kOthers) || std::ranges::any_of(before, is_velocity)) return {};
  const bool is_axis = std::ranges::find(kAxes, last) != kAxes.end();
  if (is_axis && has_any(before, kRotations)) return "q" + last;
  if (last.size() == 2 && last[0] == 'q' &&
      std::string_view("wxyz").find(last[1]) != std::string_view::npos)
    return last;
  if (last == "tx" || last == "ty" || last == "tz" || last == "px" || last == "py" || last == "pz")
    return last.substr(1);
  return is_axis && last != "w" ? last : std::string{};
}

bool is_time(std::string_view name) {
  static constexpr std::array kTimes{"timestamp", "stamp", "t", "secs", "seconds", "sec"};
  const std::vector<std::string> words = words_of(name);
  return has_any(words, kTimes) ||
         std::ranges::any_of(words, [](const std::string& word) { return word.ends_with("time"); });
}

std::int64_t unit_in(std::string_view name) {
  struct Unit {
    const char* text;
    std::int64_t ns;
  };
  for (const Unit& unit : {Unit{"[ns]", 1}, Unit{"[us]", 1'000}, Unit{"[ms]", 1'000'000},
                           Unit{"[s]", 1'000'000'000}}) {
    if (name.find(unit.text) != std::string_view::npos) return unit.ns;
  }
  return 0;
}

[[noreturn]] void reject_header(const std::string& place, std::string_view header,
                                const std::string& why) {
  throw InputError(place,
                   fmt::format("is not the header of poses ({}): '{}'", why, header.substr(0, 200)),
                   "name the columns, e.g. timestamp,x,y,z,qx,qy,qz,qw");
}

Columns columns_of(std::string_view header, const std::string& place) {
  if (parse_double(header.substr(0, header.find_first_of(" ,\t")))) {
    throw InputError(place, "begins with numbers separated by commas, without names of columns",
                     "name the columns in the first row, e.g. timestamp,x,y,z,qx,qy,qz,qw; write "
                     "decimals with points");
  }
  const std::vector<std::string_view> names = split_commas(header);
  std::optional<std::size_t> time;
  std::array<std::optional<std::size_t>, 7> numbers;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string member = member_of(names[i]);
    const auto found = std::ranges::find(kNumbers, member);
    if (found == kNumbers.end()) {
      if (!time && is_time(names[i])) time = i;
      continue;
    }
    auto& column = numbers[static_cast<std::size_t>(found - kNumbers.begin())];
    if (column) reject_header(place, header, fmt::format("two columns are '{}'", member));
    column = i;
  }
  if (!time) reject_header(place, header, "no column is a time");
  const bool is_euroc = header.find("p_RS_R_x") != std::string_view::npos;
  Columns columns{*time, {}, is_euroc ? 1 : unit_in(names[*time])};
  for (std::size_t i = 0; i < kNumbers.size(); ++i) {
    if (!numbers[i]) reject_header(place, header, fmt::format("no column is '{}'", kNumbers[i]));
    columns.numbers[i] = *numbers[i];
  }
  return columns;
}

std::optional<std::int64_t> integer(std::string_view word) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  return value;
}

/// Integers are converted exactly; the magnitude gives their unit if the header has none.
Time time_at(std::string_view word, std::int64_t unit_ns, const std::string& place) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  const auto whole = integer(word);
  if (!whole) {
    if (unit_ns == 1)
      throw InputError(place, fmt::format("'{}' is not a time in nanoseconds", word),
                       "write it as an integer");
    if (unit_ns == 0 || unit_ns == kSecond) return seconds_at(word, place);
    return Time{std::llround(finite_number(word, place) * static_cast<double>(unit_ns))};
  }
  if (unit_ns == 0) {
    const std::int64_t size = std::abs(*whole);
    unit_ns = size < 100'000'000'000           ? kSecond
              : size < 100'000'000'000'000     ? 1'000'000
              : size < 100'000'000'000'000'000 ? 1'000
                                               : 1;
  }
  if (std::abs(*whole) > std::numeric_limits<std::int64_t>::max() / unit_ns)
    throw InputError(place, fmt::format("the time {} is too large", word));
  return Time{*whole * unit_ns};
}

}  // namespace

Trajectory read_pose_csv(const std::filesystem::path& file, std::vector<StampedPose>* repeated) {
  std::string text = read_bytes(file);
  const std::string name = file.string();
  std::string_view header = std::string_view(text).substr(0, text.find('\n'));
  if (header.starts_with("\xEF\xBB\xBF")) header.remove_prefix(3);  // byte order mark
  const Columns columns = columns_of(header, name + ":1");
  if (!header.starts_with('#'))
    text.insert(static_cast<std::size_t>(header.data() - text.data()), "#");
  TextRows rows(std::move(text), name);
  TrajectoryRows poses(repeated);
  while (const auto row = rows.next()) {
    const auto parts = split_commas(*row);
    const std::string place = rows.place();
    const std::size_t last = std::max(columns.time, *std::ranges::max_element(columns.numbers));
    if (parts.size() <= last) {
      throw InputError(
          place, fmt::format("holds {} columns, the header names {}", parts.size(), last + 1));
    }
    const auto number = [&](std::size_t i) {
      return finite_number(parts[columns.numbers[i]], place);
    };
    const Eigen::Vector3d position(number(0), number(1), number(2));
    const Eigen::Quaterniond rotation(number(3), number(4), number(5), number(6));
    poses.add(time_at(parts[columns.time], columns.time_unit_ns, place),
              pose_from_row(position, rotation, place), place);
  }
  return poses.finish(name);
}

}  // namespace lidarena::dataset
