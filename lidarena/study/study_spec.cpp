// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/study/study_spec.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <set>
#include <utility>

#include "lidarena/base/config_json.hpp"
#include "lidarena/dataset/text_file.hpp"
#include "lidarena/flight/make_flight.hpp"
#include "lidarena/flight/spline_flight.hpp"
#include "lidarena/odometry/factory.hpp"
#include "lidarena/sensor/lidar.hpp"
#include "lidarena/stages/scene_settings.hpp"
#include "lidarena/study/variations.hpp"

namespace lidarena::study {
namespace {

namespace fs = std::filesystem;

std::string stem(const std::string& name_or_path) { return fs::path(name_or_path).stem().string(); }

void check_external(const StudySpec& spec) {
  for (const stages::ExternalProgram& program : spec.external) {
    if (program.name.empty() || program.command.empty()) {
      throw InputError("study", "has an external program without a name or a command");
    }
    for (const odometry::AlgorithmInfo& info : odometry::list_algorithms()) {
      if (info.name == program.name) {
        throw InputError("study", "names an external program '" + program.name +
                                      "', which is a built-in algorithm");
      }
    }
    if (program.name.find_first_of("/:") != std::string::npos) {
      throw InputError("study", "has an external program named '" + program.name + "'",
                       "use a name without '/' and ':', since a folder is named after it");
    }
  }
}

PlannedRun with_method(const StudySpec& spec, PlannedRun cell, const StudyAlgorithm& method) {
  const odometry::OdometryRequest request = parse_algorithm(method.name);
  const bool external = find_external(spec, method.name) != nullptr;
  cell.algorithm = request.algorithm;
  cell.preset = external ? "external" : request.preset;
  cell.as = method.as;
  cell.settings = method.set;
  cell.parts = method.parts;
  for (const std::string& name : method.also) {
    const std::string& sensor = *std::ranges::find(spec.sensors, name, stem);
    if (sensor == cell.sensor || std::ranges::find(cell.also, sensor) != cell.also.end())
      throw InputError("study", "adds the sensor '" + name + "' twice to scans of " + method.name,
                       "name it once in also, and leave it out of the method's sensors");
    cell.also.push_back(sensor);
  }
  if (!cell.also.empty() && !cell.recording.empty())
    throw InputError("study", "adds sensors to those of a recording by also of " + method.name,
                     "fly it in scenes alone");
  if (cell.parts == 0) cell.parts = external ? 1 : odometry::parts_of(request);
  return cell;
}

PlannedRun cell_of(const StudySpec& spec, const StudyScene& scene, std::uint64_t seed,
                   std::optional<sensor::ScanMode> mode, const std::string& sensor,
                   const StudyAlgorithm& method) {
  PlannedRun cell;
  cell.dataset = fmt::format("{}-{}-s{}", stem(scene.world), stem(scene.flight), seed);
  if (mode)
    cell.dataset = fmt::format("{}-{}", cell.dataset, value_to_json(*mode).get<std::string>());
  cell.world = scene.world;
  cell.flight = scene.flight;
  cell.sensor = sensor;
  cell.seed = seed;
  cell.seconds = scene.seconds;
  cell.allow_missing = scene.allow_missing;
  cell.mode = mode;
  return with_method(spec, cell, method);
}

/// Without a method.
PlannedRun cell_of(const StudyRecording& recording) {
  PlannedRun cell;
  cell.dataset = cell.world = cell.recording = recording.name;
  cell.sensor = recording.sensor.empty() ? "lidar" : recording.sensor;
  std::ranges::replace(cell.sensor, '/', '_');
  cell.seed = 0;
  return cell;
}

std::string name_of(const PlannedRun& cell) {
  return fmt::format("{}-{}-{}{}{}{}", cell.dataset, stem(cell.sensor), cell.label(),
                     cell.preset.empty() ? "" : "-", cell.preset, cell.method_part);
}

/// Whether the study flies the method with the sensor.
bool is_flown(const StudyAlgorithm& method, const std::string& sensor) {
  return method.sensors.empty() ||
         std::ranges::find(method.sensors, stem(sensor)) != method.sensors.end();
}

void check_sensors_of(const StudyAlgorithm& method, const std::vector<std::string>& sensors) {
  for (const auto* named : {&method.sensors, &method.also}) {
    for (const std::string& name : *named) {
      if (std::ranges::find(sensors, name, stem) != sensors.end()) continue;
      throw InputError(
          "study",
          "flies " + method.name + " with the sensor '" + name + "', which it does not name",
          "add it to sensors, or remove it there");
    }
  }
}

void check_names_differ(const std::vector<PlannedRun>& cells) {
  std::vector<std::string> names;
  for (const PlannedRun& cell : cells) names.push_back(cell.name);
  std::ranges::sort(names);
  const auto duplicate = std::ranges::adjacent_find(names);
  if (duplicate != names.end()) {
    throw InputError("study", "plans two runs called " + *duplicate,
                     "scenes, sensors, algorithms and seeds need names that differ");
  }
}

/// The settings of the cell's flight.
stages::SceneSettings settings_of(const PlannedRun& cell, const stages::ConfigFolder& configs) {
  return stages::scene_settings(cell.set, {configs.resolve("sensors", cell.sensor)});
}

/// Throws InputError if settings of a flight exclude each other, such as fast sweeps of the heading
/// and a low yaw rate: each is tried on a straight line.
void check_flights(const std::vector<PlannedRun>& cells, const stages::ConfigFolder& configs) {
  const std::array line{Eigen::Vector3d(0.0, 0.0, 0.0), Eigen::Vector3d(10.0, 0.0, 0.0)};
  std::set<std::pair<std::string, std::vector<std::string>>> tried;
  for (const PlannedRun& cell : cells) {
    if (!cell.recording.empty()) continue;
    const fs::path file = configs.resolve("flights", cell.flight);
    const std::vector<std::string> set = settings_of(cell, configs).flight;
    if (file.extension() != ".yaml" || !tried.emplace(cell.flight, set).second) continue;
    flight::FlightConfig config = flight::load_flight(file, set);
    if (config.kind == flight::FlightKind::kReplay) continue;
    config.duration_s = 0.0;  // once along the line
    const std::string with = set.empty() ? "" : fmt::format(" with {}", fmt::join(set, ", "));
    const flight::SplineFlight on_line(line, config, file.string() + with);
  }
}

/// Length of the cell's flight, s; a guess if the flight's file gives no duration.
double expected_seconds(const PlannedRun& cell, const stages::ConfigFolder& configs) {
  constexpr double kUnknown = 120.0;
  double seconds = cell.seconds;
  const fs::path flight = configs.resolve("flights", cell.flight);
  if (seconds == 0.0 && flight.extension() == ".yaml")
    seconds = flight::load_flight(flight, settings_of(cell, configs).flight).duration_s;
  return seconds == 0.0 ? kUnknown : seconds;
}

/// The methods of a study, each with one value for each of its settings.
std::vector<StudyAlgorithm> methods_of(const StudySpec& spec) {
  std::vector<std::string> outside;
  for (const stages::ExternalProgram& program : spec.external) outside.push_back(program.name);
  return with_single_values(spec.algorithms, outside);
}

/// The names by which expectations call the study's cells.
results::CellFilter names_of(const StudySpec& spec) {
  results::CellFilter names;
  for (const StudyScene& scene : spec.scenes) names.world.push_back(stem(scene.world));
  for (const StudyRecording& recording : spec.recordings) names.world.push_back(recording.name);
  for (const std::string& sensor : spec.sensors) names.sensor.push_back(stem(sensor));
  for (const StudyAlgorithm& method : methods_of(spec))
    names.algorithm.push_back(method.as.empty() ? parse_algorithm(method.name).algorithm
                                                : method.as);
  return names;
}

double shots_per_second(const std::string& sensor, const stages::ConfigFolder& configs,
                        const std::vector<std::string>& set = {}) {
  const auto pattern = sensor::make_pattern(
      sensor::load_sensor(configs.resolve("sensors", sensor), configs.root() / "sensors", set));
  return static_cast<double>(pattern->beams_per_scan()) / to_seconds(pattern->period());
}

}  // namespace

odometry::OdometryRequest parse_algorithm(const std::string& text) {
  odometry::OdometryRequest request;
  const std::size_t colon = text.find(':');
  request.algorithm = text.substr(0, colon);
  if (colon != std::string::npos) request.preset = text.substr(colon + 1);
  return odometry::with_default_preset(std::move(request));
}

const StudyRecording* recording_of(const StudySpec& spec, const PlannedRun& cell) {
  if (cell.recording.empty()) return nullptr;
  return &*std::ranges::find(spec.recordings, cell.recording, &StudyRecording::name);
}

const stages::ExternalProgram* find_external(const StudySpec& spec, const std::string& name) {
  const auto found = std::ranges::find(spec.external, name, &stages::ExternalProgram::name);
  return found == spec.external.end() ? nullptr : &*found;
}

StudySpec load_study(const fs::path& file) {
  const auto own = load_config<StudySpec>(file);
  if (own.base.empty()) return own;
  const fs::path base = file.parent_path() / own.base;
  auto spec = load_config<StudySpec>(base);
  if (!spec.base.empty())
    throw InputError(base.string(), "is the base of a study and has a base itself",
                     "name " + spec.base + " in " + file.string());
  read_config(ConfigNode::load(file), spec);
  return spec;
}

std::vector<results::ReferenceFigure> load_reference(const StudySpec& spec,
                                                     const stages::ConfigFolder& configs) {
  if (spec.reference.empty()) return {};
  constexpr std::string_view kHeader = "world,sensor,algorithm,figure,value";
  const fs::path beside = configs.root() / "studies" / spec.reference;
  dataset::TextRows rows(fs::exists(beside) ? beside : fs::path(spec.reference));
  if (rows.next() != kHeader) {
    throw InputError(rows.place(), fmt::format("is not the header {}", kHeader));
  }
  std::vector<results::ReferenceFigure> figures;
  while (const auto row = rows.next()) {
    const auto parts = dataset::split_commas(*row);
    if (parts.size() != 5) {
      throw InputError(rows.place(), fmt::format("holds {} columns, not 5", parts.size()));
    }
    figures.push_back({std::string(parts[0]), std::string(parts[1]), std::string(parts[2]),
                       std::string(parts[3]), dataset::finite_number(parts[4], rows.place())});
  }
  return figures;
}

std::vector<PlannedRun> planned_cells(const StudySpec& spec, const stages::ConfigFolder& configs) {
  const auto need = [](bool there, const char* what) {
    if (!there) throw InputError("study", std::string("names no ") + what);
  };
  need(!spec.scenes.empty() || !spec.recordings.empty(), "scenes");
  need(!spec.sensors.empty() || spec.scenes.empty(), "sensors");
  need(!spec.algorithms.empty(), "algorithms");
  need(!spec.seeds.empty(), "seeds");
  for (const std::string& sensor : spec.sensors) configs.load_sensor(sensor);
  check_external(spec);
  for (const results::Expectation& expectation : spec.expect)
    results::check(expectation, names_of(spec), "study");
  const std::vector<StudyAlgorithm> methods = methods_of(spec);
  for (const StudyAlgorithm& method : methods) check_sensors_of(method, spec.sensors);
  const std::vector<Variation> variations = variations_of(spec);
  CellSettings settings(spec, methods, configs);

  std::vector<std::optional<sensor::ScanMode>> modes(spec.modes.begin(), spec.modes.end());
  if (modes.empty()) modes.emplace_back();
  std::vector<PlannedRun> cells;
  const auto add = [&](const PlannedRun& base, const Variation& variation) {
    PlannedRun cell = settings.varied(base, variation, variations);
    cell.name = name_of(cell);
    const bool is_planned = cell.variation.empty() && !variation.settings.empty();  // as the base
    if (!is_planned) cells.push_back(std::move(cell));
  };
  for (const StudyScene& scene : spec.scenes) {
    configs.resolve("worlds", scene.world);
    configs.resolve("flights", scene.flight);
    for (const std::uint64_t seed : scene.seeds.empty() ? spec.seeds : scene.seeds) {
      for (const std::optional<sensor::ScanMode> mode : modes) {
        for (const Variation& variation : variations) {
          for (const std::string& sensor : spec.sensors) {
            for (const StudyAlgorithm& method : methods) {
              if (is_flown(method, sensor))
                add(cell_of(spec, scene, seed, mode, sensor, method), variation);
            }
          }
        }
      }
    }
  }
  for (const StudyRecording& recording : spec.recordings) {
    const PlannedRun flown = cell_of(resolved(recording, configs));
    for (const Variation& variation : variations) {
      for (const StudyAlgorithm& method : methods) add(with_method(spec, flown, method), variation);
    }
  }
  check_names_differ(cells);
  check_flights(cells, configs);
  return cells;
}

Shard parse_shard(const std::string& text) {
  Shard shard{0, 0};
  const std::size_t slash = text.find('/');
  const auto number = [](std::string_view digits, int& value) {
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    return error == std::errc{} && end == digits.data() + digits.size();
  };
  const std::string_view all = text;
  const bool is_valid = slash != std::string::npos && number(all.substr(0, slash), shard.part) &&
                        number(all.substr(slash + 1), shard.of) && 1 <= shard.part &&
                        shard.part <= shard.of;
  if (!is_valid)
    throw InputError("--shard " + text, "is not a part of a study", "write K/N, from 1/N to N/N");
  return shard;
}

CellEstimate estimate(const StudySpec& spec, const PlannedRun& cell,
                      const stages::ConfigFolder& configs) {
  // Means of five methods on flights of 20 and 40 s; methods differ by a factor of about 2.
  constexpr double kSecondsOfRun = 2.0, kSecondsOfFlightSecond = 0.22, kSecondsOfShot = 0.07e-6;
  constexpr double kMegabytesOfRun = 20.0;
  constexpr double kMapMegabytesOfFlightSecond = 1.0, kMapMegabytesOfShot = 1e-6;
  // Without maps.
  constexpr double kSecondsOfTrack = 0.5, kSecondsOfTrackSecond = 0.12;
  constexpr double kSecondsOfTrackedShot = 0.05e-6, kMegabytesOfTrackSecond = 0.05;
  constexpr double kBytesOfRecordedShot = 20.0;
  if (const StudyRecording* recording = recording_of(spec, cell)) {
    const double shots = static_cast<double>(bytes_of(*recording)) / kBytesOfRecordedShot;
    return {kSecondsOfRun + kSecondsOfShot * shots, kMegabytesOfRun, kMapMegabytesOfShot * shots};
  }
  const double seconds = expected_seconds(cell, configs);
  const double shots =
      seconds * shots_per_second(cell.sensor, configs, settings_of(cell, configs).sensors.front());
  if (!stages::scores_maps(spec.score))
    return {kSecondsOfTrack + kSecondsOfTrackSecond * seconds + kSecondsOfTrackedShot * shots,
            kMegabytesOfTrackSecond * seconds, 0.0};
  return {kSecondsOfRun + kSecondsOfFlightSecond * seconds + kSecondsOfShot * shots,
          kMegabytesOfRun, kMapMegabytesOfFlightSecond * seconds + kMapMegabytesOfShot * shots};
}

std::uint64_t data_bytes(const StudySpec& spec, const PlannedRun& cell,
                         const stages::ConfigFolder& configs) {
  if (!cell.recording.empty()) return 0;
  constexpr double kBytesOfShot = 24.0;     // of a point, see formats.md
  constexpr double kBytesOfSecond = 1.5e6;  // the true trajectory and the IMUs
  constexpr double kBytesOfHits = 6.4e6;    // 20,000 of 32 bytes, ten times a second
  double bytes_per_second = kBytesOfSecond;
  for (const std::string& sensor : spec.sensors)
    bytes_per_second += kBytesOfHits + kBytesOfShot * shots_per_second(sensor, configs);
  return static_cast<std::uint64_t>(expected_seconds(cell, configs) * bytes_per_second);
}

}  // namespace lidarena::study
