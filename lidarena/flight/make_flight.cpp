// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/flight/make_flight.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <fstream>
#include <optional>
#include <sstream>

#include "lidarena/base/config.hpp"
#include "lidarena/base/trajectory.hpp"
#include "lidarena/flight/clearance.hpp"
#include "lidarena/flight/figures.hpp"
#include "lidarena/flight/flight_config.hpp"
#include "lidarena/flight/replay_flight.hpp"
#include "lidarena/flight/spline_flight.hpp"

namespace lidarena {
namespace {

/// Decimal seconds as integer nanoseconds, so that nothing of a large stamp is lost to `double`.
std::optional<Time> exact_seconds(const std::string& text) {
  const std::size_t dot = std::min(text.find('.'), text.size());
  std::int64_t seconds = 0;
  const auto whole = std::from_chars(text.data(), text.data() + dot, seconds);
  if (whole.ec != std::errc{} || whole.ptr != text.data() + dot) return std::nullopt;
  std::string digits = dot < text.size() ? text.substr(dot + 1) : "";
  if (digits.find_first_not_of("0123456789") != std::string::npos) return std::nullopt;
  digits.resize(9, '0');
  const std::int64_t fraction = std::stoll(digits);
  return std::chrono::seconds(seconds) + Time{text.front() == '-' ? -fraction : fraction};
}

StampedPose tum_row(const std::string& line, const std::string& place) {
  std::istringstream in(line);
  std::string stamp;
  std::array<double, 7> v{};
  in >> stamp;
  for (double& value : v) in >> value;
  std::string rest;
  if (!in || in >> rest) throw InputError(place, "is not a row 't x y z qx qy qz qw'");
  std::optional<Time> time = exact_seconds(stamp);
  if (!time) {  // with an exponent
    double seconds = 0.0;
    const auto end = stamp.data() + stamp.size();
    const auto [ptr, error] = std::from_chars(stamp.data(), end, seconds);
    if (error != std::errc{} || ptr != end)
      throw InputError(place, "has no time in its first column");
    time = from_seconds(seconds);
  }
  const Eigen::Quaterniond q(v[6], v[3], v[4], v[5]);
  if (!(std::abs(q.norm() - 1.0) < 1e-2)) {
    throw InputError(place, fmt::format("the quaternion has norm {:g}", q.norm()),
                     "the columns are t x y z qx qy qz qw");
  }
  return {*time, make_pose(q, {v[0], v[1], v[2]})};
}

/// The rows of a TUM file. (lidarena/dataset reads the same files; flight may not include it.)
Trajectory read_recording(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in)
    throw InputError(file.string(), "cannot be opened", "check the name and its permissions");
  std::vector<StampedPose> poses;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    const std::size_t first = line.find_first_not_of(" \t\r");
    if (first == std::string::npos || line[first] == '#') continue;
    poses.push_back(tum_row(line, fmt::format("{}:{}", file.string(), number)));
  }
  return Trajectory(std::move(poses), file.string());
}

bool is_recording(const std::filesystem::path& file) {
  return file.extension() == ".tum" || file.extension() == ".txt";
}

/// A bare recording has no configuration; it only must not pass through a surface.
FlightConfig config_of(const std::filesystem::path& file) {
  if (!is_recording(file)) return load_config<FlightConfig>(file);
  FlightConfig config;
  config.kind = FlightKind::kReplay;
  config.replay = file.filename().string();
  config.clearance_m = 0.0;
  return config;
}

const std::vector<Eigen::Vector3d>& route_of(const WorldModel& model, int route,
                                             const std::string& place) {
  const auto index = static_cast<std::size_t>(route);
  if (index < model.routes.size()) return model.routes[index];
  throw InputError(place,
                   fmt::format("the world '{}' has {} route(s); route {} is asked for (from 0)",
                               model.name, model.routes.size(), route),
                   model.routes.empty() ? "use kind: waypoints, or a world that knows its routes"
                                        : "choose a lower number");
}

std::unique_ptr<Flight> build(const std::filesystem::path& file, const FlightConfig& config,
                              const WorldModel& model) {
  const std::string place = file.string();
  switch (config.kind) {
    case FlightKind::kReplay: {
      if (config.replay.empty()) throw InputError(place, "names no file to replay", "set replay");
      const auto recording = file.parent_path() / config.replay;
      return std::make_unique<ReplayFlight>(read_recording(recording), config.placement,
                                            recording.string());
    }
    case FlightKind::kRoute:
      return std::make_unique<SplineFlight>(route_of(model, config.route, place), config, place);
    case FlightKind::kWaypoints:
      break;
  }
  return std::make_unique<SplineFlight>(config.waypoints, config, place);
}

void require_clear(const Flight& flight, const World& world, double clearance,
                   const std::string& place) {
  const auto encounter = first_encounter(flight, world, clearance);
  if (!encounter) return;
  const Eigen::Vector3d& p = encounter->position;
  const std::string what =
      encounter->distance == 0.0
          ? std::string("passes through a surface")
          : fmt::format("comes within {:.3f} m of a surface", encounter->distance);
  throw InputError(
      place,
      fmt::format("the flight {} at ({:.2f}, {:.2f}, {:.2f}), {:.2f} s after its begin", what,
                  p.x(), p.y(), p.z(), to_seconds(encounter->time)),
      fmt::format("move the waypoints there, or lower clearance_m ({:g}) or corner_m", clearance));
}

}  // namespace

std::unique_ptr<Flight> make_flight(const std::filesystem::path& file, const WorldModel& model,
                                    const World& world, LogSink& log) {
  const FlightConfig config = config_of(file);
  std::unique_ptr<Flight> flight = build(file, config, model);
  require_clear(*flight, world, config.clearance_m, file.string());
  log.info(fmt::format("flight {}: {}", file.string(), describe(figures_of(*flight))));
  return flight;
}

}  // namespace lidarena
