// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/flight/make_flight.hpp"

#include <fmt/format.h>

#include "lidarena/base/config.hpp"
#include "lidarena/flight/clearance.hpp"
#include "lidarena/flight/figures.hpp"
#include "lidarena/flight/find_place.hpp"
#include "lidarena/flight/fly_quadrotor.hpp"
#include "lidarena/flight/late_start.hpp"
#include "lidarena/flight/recorded_imu_flight.hpp"
#include "lidarena/flight/recording.hpp"
#include "lidarena/flight/replay_flight.hpp"
#include "lidarena/flight/spline_flight.hpp"
#include "lidarena/flight/tour.hpp"

namespace lidarena::flight {
namespace {

bool is_recording(const std::filesystem::path& file) {
  return file.extension() == ".tum" || file.extension() == ".txt";
}

const std::vector<Eigen::Vector3d>& route_of(const world::WorldModel& model, int route,
                                             const std::string& place) {
  const auto index = static_cast<std::size_t>(route);
  if (index < model.routes.size()) return model.routes[index];
  throw InputError(place,
                   fmt::format("the world '{}' has {} route(s), but route {} (from 0) is selected",
                               model.name, model.routes.size(), route),
                   model.routes.empty() ? "use kind: waypoints, or a world that provides routes"
                                        : "choose a lower number");
}

std::unique_ptr<Flight> replayed(const std::filesystem::path& file, const FlightConfig& config,
                                 const world::WorldModel& model, const world::World& world,
                                 LogSink& log) {
  const std::string place = file.string();
  if (config.replay.empty())
    throw InputError(place, "the key 'replay' is missing", "set replay to a TUM file");
  if (config.speed != 1.0)
    throw InputError(place, "a recorded flight has the speed of its recording", "remove speed");
  const bool is_recorded = config.imu == ImuSource::kRecorded;
  if (is_recorded && config.replay_imu.empty())
    throw InputError(place, "imu: recorded needs the samples of an IMU",
                     "set replay_imu to their file");
  if (is_recorded && config.dynamics)
    throw InputError(place, "a simulated quadrotor does not fly as the recorded IMU did",
                     "remove dynamics, or set imu: simulated");
  const auto recording = file.parent_path() / config.replay;
  const Trajectory poses = thinned(read_recording(recording), config.replay_step_s);
  std::optional<ImuSplineFit> fit;
  std::vector<ImuSample> samples;
  if (!config.replay_imu.empty()) {
    samples = read_imu_recording(file.parent_path() / config.replay_imu);
    fit = fit_imu_spline(poses, samples, config.imu_fit, recording.string());
    log.info(fmt::format("flight {}: {}", place, describe(*fit)));
    if (!is_recorded) samples.clear();
  }
  const auto placed_at = [&](const Pose& world_from_recording) -> std::unique_ptr<Flight> {
    if (fit)
      return std::make_unique<RecordedImuFlight>(*fit, samples, poses.begin_time(),
                                                 world_from_recording, config.recorded_from_body,
                                                 place);
    return std::make_unique<ReplayFlight>(
        placed(poses, world_from_recording, config.recorded_from_body), recording.string());
  };
  if (!config.find_place) return placed_at(config.world_from_recording);
  return placed_at(
      find_place(*placed_at(Pose::Identity()), model, world, config.clearance_m, place));
}

std::unique_ptr<Flight> build(const std::filesystem::path& file, const FlightConfig& config,
                              const world::WorldModel& model, const world::World& world,
                              LogSink& log) {
  const std::string place = file.string();
  switch (config.kind) {
    case FlightKind::kReplay:
      return replayed(file, config, model, world, log);
    case FlightKind::kRoute:
      return std::make_unique<SplineFlight>(route_of(model, config.route, place), config, place);
    case FlightKind::kAuto: {
      const Tour tour = plan_tour(model, world, config, place, Parallel());
      log.info(fmt::format("flight {}: {}", place, describe(tour)));
      return std::make_unique<SplineFlight>(tour.waypoints, config, place);
    }
    case FlightKind::kWaypoints:
      break;
  }
  return std::make_unique<SplineFlight>(config.waypoints, config, place);
}

std::unique_ptr<Flight> flown(const Flight& reference, const DynamicsConfig& dynamics,
                              const std::string& place, LogSink& log) {
  std::unique_ptr<Flight> flight = fly_quadrotor(reference, dynamics, place);
  const TrackingError error = tracking_error(*flight, reference);
  log.info(fmt::format("flight {}: quadrotor, tracking error {:.3f} m rms and at most {:.3f} m",
                       place, error.rms_m, error.max_m));
  return flight;
}

/// When the recording begins, s after the begin of the whole flight.
double begin_of_recording(const FlightConfig& config) {
  if (!config.begin_s) return 0.0;
  return *config.begin_s + (config.kind == FlightKind::kReplay ? 0.0 : config.hover_s);
}

std::unique_ptr<Flight> from(std::unique_ptr<Flight> flight, double begin_s,
                             const std::string& place) {
  if (begin_s == 0.0) return flight;
  if (from_seconds(begin_s) < flight->duration())
    return std::make_unique<LateStart>(std::move(flight), from_seconds(begin_s));
  throw InputError(place,
                   fmt::format("the recording begins {:g} s after the start of a flight of {:g} s",
                               begin_s, to_seconds(flight->duration())),
                   "reduce begin_s, or give a longer duration_s");
}

void require_clear(const Flight& flight, const world::World& world, double clearance,
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
      fmt::format("the flight {} at ({:.2f}, {:.2f}, {:.2f}), {:.2f} s after its start", what,
                  p.x(), p.y(), p.z(), to_seconds(encounter->time)),
      fmt::format("move the nearby waypoints, or reduce clearance_m ({:g}) or corner_m",
                  clearance));
}

}  // namespace

FlightConfig load_flight(const std::filesystem::path& file, const std::vector<std::string>& set) {
  if (is_recording(file) && !set.empty())
    throw InputError("--set flight." + set.front(), file.string() + " has no keys",
                     "name the recording in a flight's file (kind: replay)");
  FlightConfig config;
  if (is_recording(file)) {
    config.kind = FlightKind::kReplay;
    config.replay = file.filename().string();
    config.clearance_m = 0.0;
  } else {
    config = load_config<FlightConfig>(file);
  }
  for (const std::string& assignment : set) set_field(config, assignment);
  return config;
}

std::unique_ptr<Flight> make_flight(const std::filesystem::path& file,
                                    const world::WorldModel& model, const world::World& world,
                                    LogSink& log, std::optional<std::uint64_t> gust_seed,
                                    const std::vector<std::string>& set) {
  FlightConfig config = load_flight(file, set);
  if (config.dynamics && gust_seed) config.dynamics->gusts.seed = *gust_seed;
  const double begin_s = begin_of_recording(config);
  if (config.duration_s > 0.0) config.duration_s += begin_s;
  std::unique_ptr<Flight> flight = build(file, config, model, world, log);
  if (config.dynamics) flight = flown(*flight, *config.dynamics, file.string(), log);
  require_clear(*flight, world, config.clearance_m, file.string());
  flight = from(std::move(flight), begin_s, file.string());
  log.info(fmt::format("flight {}: {}", file.string(), describe(figures_of(*flight))));
  return flight;
}

}  // namespace lidarena::flight
