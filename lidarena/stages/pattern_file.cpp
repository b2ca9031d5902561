// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/stages/pattern_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cmath>
#include <functional>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "lidarena/base/angle.hpp"
#include "lidarena/base/config_json.hpp"
#include "lidarena/base/error.hpp"
#include "lidarena/dataset/part_file.hpp"
#include "lidarena/sensor/scan_pattern.hpp"

namespace lidarena::stages {
namespace {

using dataset::PartFile;
using sensor::Beam;

static_assert(std::endian::native == std::endian::little, "the binary files are little-endian");

constexpr double kLongestDefault = 30.0;          // s
constexpr std::uint64_t kMaxShots = 100'000'000;  // 6.4 GB as .npy
constexpr std::size_t kNpyColumns = 8;
// Of NVIDIA's example profiles; no figures of our sensors. They matter for intensities alone.
constexpr double kPulsePowerW = 0.002, kWavelengthNm = 905.0, kPulseNs = 6.0;

/// Step of the ranges in profiles of Isaac Sim, m: a millimeter if the sensor does not round.
double range_step(const sensor::SensorConfig& sensor) {
  return sensor.noise.range_step_m > 0.0 ? sensor.noise.range_step_m : 0.001;
}

/// The part of a pattern that is written.
struct Part {
  const sensor::SensorConfig& sensor;
  const sensor::ScanPattern& pattern;
  std::uint64_t scans;

  std::uint64_t shots() const { return scans * pattern.beams_per_scan(); }

  /// Calls `visit(scan, beams)` for each scan.
  template <class Visit>
  void for_scans(Visit&& visit) const {
    std::vector<Beam> beams;
    for (std::uint64_t scan = 0; scan < scans; ++scan) {
      pattern.beams(scan, beams);
      visit(scan, std::as_const(beams));
    }
  }

  std::int64_t time_ns(std::uint64_t scan, const Beam& beam) const {
    return static_cast<std::int64_t>(scan) * pattern.period().count() + beam.dt_ns;
  }
};

void write_npy(const Part& part, PartFile& out) {
  constexpr std::size_t kPrelude = 10, kAlignment = 64;
  std::string header = fmt::format(
      "{{'descr': '<f8', 'fortran_order': False, 'shape': ({}, {}), }}", part.shots(), kNpyColumns);
  header.append(kAlignment - (kPrelude + header.size() + 1) % kAlignment, ' ').append("\n");
  const auto size = static_cast<std::uint16_t>(header.size());
  out.write(std::string_view("\x93NUMPY\x01\x00", 8));
  out.write(std::as_bytes(std::span(&size, 1)));
  out.write(header);
  part.for_scans([&](std::uint64_t scan, const std::vector<Beam>& beams) {
    std::vector<std::array<double, kNpyColumns>> rows;
    rows.reserve(beams.size());
    for (const Beam& b : beams) {
      rows.push_back({1e-9 * static_cast<double>(part.time_ns(scan, b)), b.direction.x(),
                      b.direction.y(), b.direction.z(), static_cast<double>(b.ring), b.origin.x(),
                      b.origin.y(), b.origin.z()});
    }
    out.write(std::as_bytes(std::span(rows)));
  });
}

void write_csv(const Part& part, PartFile& out) {
  out.write("time_ns,x,y,z,ring,origin_x,origin_y,origin_z\n");
  part.for_scans([&](std::uint64_t scan, const std::vector<Beam>& beams) {
    fmt::memory_buffer text;
    for (const Beam& b : beams) {
      fmt::format_to(std::back_inserter(text), "{},{:.9g},{:.9g},{:.9g},{},{:.9g},{:.9g},{:.9g}\n",
                     part.time_ns(scan, b), b.direction.x(), b.direction.y(), b.direction.z(),
                     b.ring, b.origin.x(), b.origin.y(), b.origin.z());
    }
    out.write(std::string_view(text.data(), text.size()));
  });
}

/// The ray along +z, turned about y by the zenith angle, then about z by the azimuth.
std::array<float, 12> ray_matrix(const Beam& beam) {
  const Eigen::Vector3d d = beam.direction.cast<double>();
  const double azimuth = std::atan2(d.y(), d.x()), zenith = std::acos(std::clamp(d.z(), -1.0, 1.0));
  const auto f = [](double value) { return static_cast<float>(value); };
  const double ca = std::cos(azimuth), sa = std::sin(azimuth);
  const double cz = std::cos(zenith), sz = std::sin(zenith);
  return {f(cz * ca), f(-sa), beam.direction.x(), beam.origin.x(),
          f(cz * sa), f(ca),  beam.direction.y(), beam.origin.y(),
          f(-sz),     0.0F,   beam.direction.z(), beam.origin.z()};
}

void write_matrices(const Part& part, PartFile& out) {
  part.for_scans([&](std::uint64_t, const std::vector<Beam>& beams) {
    std::vector<std::array<float, 12>> matrices;
    matrices.reserve(beams.size());
    for (const Beam& beam : beams) matrices.push_back(ray_matrix(beam));
    out.write(std::as_bytes(std::span(matrices)));
  });
}

/// A list "1, 2, 3" of what `value` gives for each beam and its index.
template <class Value>
std::string list_of(const std::vector<Beam>& beams, Value&& value) {
  fmt::memory_buffer text;
  for (std::size_t i = 0; i < beams.size(); ++i) {
    if (i > 0) text.append(std::string_view(", "));
    fmt::format_to(std::back_inserter(text), "{}", value(beams[i], i));
  }
  return fmt::to_string(text);
}

/// The lists of an emitter state by their names in Isaac Sim, each with its USD type.
std::vector<std::array<std::string, 3>> emitter_lists(const std::vector<Beam>& beams) {
  const auto azimuth = [](const Beam& b, std::size_t) {
    return static_cast<float>(std::atan2(b.direction.y(), b.direction.x()) / kDegree);
  };
  const auto elevation = [](const Beam& b, std::size_t) {
    return static_cast<float>(std::asin(std::clamp(b.direction.z(), -1.0F, 1.0F)) / kDegree);
  };
  return {
      {"float[]", "azimuthDeg", list_of(beams, azimuth)},
      {"float[]", "elevationDeg", list_of(beams, elevation)},
      {"uint[]", "fireTimeNs", list_of(beams, [](const Beam& b, std::size_t) { return b.dt_ns; })},
      {"uint[]", "channelId", list_of(beams, [](const Beam&, std::size_t i) { return i + 1; })},
      {"uint[]", "rangeId", list_of(beams, [](const Beam&, std::size_t) { return 0; })},
      {"uint[]", "bank", list_of(beams, [](const Beam&, std::size_t) { return 0; })}};
}

void write_profile(const Part& part, PartFile& out) {
  const sensor::SensorConfig& s = part.sensor;
  const std::size_t shots = part.pattern.beams_per_scan();
  out.write(fmt::format(R"({{
"class": "sensor", "type": "lidar", "name": {}, "driveWorksId": "GENERIC",
"profile": {{
"scanType": "solidState", "intensityProcessing": "normalization", "rayType": "IDEALIZED",
"nearRangeM": {}, "farRangeM": {}, "minDistBetweenEchos": {},
"startAzimuthDeg": -180.0, "endAzimuthDeg": 180.0,
"upElevationDeg": 90.0, "downElevationDeg": -90.0,
"rangeResolutionM": {}, "rangeAccuracyM": {},
"avgPowerW": {}, "minReflectance": 0.1, "minReflectanceRange": {},
"wavelengthNm": {}, "pulseTimeNs": {}, "maxReturns": 1,
"scanRateBaseHz": {}, "reportRateBaseHz": {},
"numberOfEmitters": {}, "numberOfChannels": {}, "numLines": 1, "numRaysPerLine": [{}],
"rangeCount": 1, "ranges": [{{"min": {}, "max": {}}}],
"azimuthErrorMean": 0.0, "azimuthErrorStd": {}, "elevationErrorMean": 0.0, "elevationErrorStd": {},
"stateResolutionStep": 1, "emitterStateCount": {},
"emitterStates": [)",
                        Json(s.name).dump(), s.min_range_m, s.max_range_m, s.min_range_m,
                        s.noise.range_step_m, s.range_noise_m, kPulsePowerW, s.max_range_m,
                        kWavelengthNm, kPulseNs, s.rate_hz, s.rate_hz, shots, shots, shots,
                        s.min_range_m, s.max_range_m, s.noise.angle_noise_deg,
                        s.noise.angle_noise_deg, part.scans));
  part.for_scans([&](std::uint64_t scan, const std::vector<Beam>& beams) {
    out.write(scan == 0 ? "\n{" : ",\n{");
    const char* separator = "\n";
    for (const auto& [type, name, list] : emitter_lists(beams)) {
      out.write(fmt::format("{}\"{}\": [{}]", separator, name, list));
      separator = ",\n";
    }
    out.write("}");
  });
  out.write("\n]\n}\n}\n");
}

/// The name as that of a USD prim: letters, digits and '_', not beginning with a digit.
std::string prim_name(std::string name) {
  std::ranges::replace_if(
      name, [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
  if (name.empty() || std::isdigit(static_cast<unsigned char>(name.front())) != 0)
    name = "_" + name;
  return name;
}

void write_prim(const Part& part, PartFile& out) {
  const sensor::SensorConfig& s = part.sensor;
  const std::string name = prim_name(s.name);
  std::string schemas = "\"OmniSensorGenericLidarCoreAPI\"";
  for (std::uint64_t scan = 1; scan < part.scans; ++scan)
    schemas += fmt::format(", \"OmniSensorGenericLidarCoreEmitterStateAPI:s{:03}\"", scan + 1);
  out.write(fmt::format(R"(#usda 1.0
(
    defaultPrim = "{0}"
    metersPerUnit = 1
    upAxis = "Z"
)

def OmniLidar "{0}" (
    prepend apiSchemas = [{1}]
)
{{
    string omni:sensor:marketName = "{0}"
    float omni:sensor:tickRate = {2}
)",
                        name, schemas, s.rate_hz));
  const auto set = [&](const char* type, const std::string& key, const auto& value) {
    out.write(fmt::format("    {} omni:sensor:Core:{} = {}\n", type, key, value));
  };
  const std::size_t shots = part.pattern.beams_per_scan();
  const std::string list_of_shots = fmt::format("[{}]", shots);
  set("token", "scanType", "\"SOLID_STATE\"");
  set("token", "rayType", "\"IDEALIZED\"");
  set("uint", "scanRateBaseHz", s.rate_hz);
  set("uint", "reportRateBaseHz", s.rate_hz);
  set("uint", "patternFiringRateHz", s.rate_hz);
  set("uint", "numberOfEmitters", shots);
  set("uint", "numberOfChannels", shots);
  set("uint", "numLines", 1);
  set("uint[]", "numRaysPerLine", list_of_shots);
  set("uint", "stateResolutionStep", 1);
  set("uint", "maxReturns", 1);
  set("float", "nearRangeM", s.min_range_m);
  set("float", "farRangeM", s.max_range_m);
  set("float", "minDistBetweenEchosM", s.min_range_m);
  set("uint", "rangeCount", 1);
  set("float[]", "rangesMinM", fmt::format("[{}]", s.min_range_m));
  set("float[]", "rangesMaxM", fmt::format("[{}]", s.max_range_m));
  set("float", "rangeResolutionM", range_step(s));
  set("float", "rangeAccuracyM", s.range_noise_m);
  set("float", "azimuthErrorStd", s.noise.angle_noise_deg);
  set("float", "elevationErrorStd", s.noise.angle_noise_deg);
  part.for_scans([&](std::uint64_t scan, const std::vector<Beam>& beams) {
    for (const auto& [type, key, list] : emitter_lists(beams))
      set(type.c_str(), fmt::format("emitterState:s{:03}:{}", scan + 1, key), "[" + list + "]");
  });
  out.write("}\n");
}

struct Format {
  std::string name;
  std::function<void(const Part&, PartFile&)> write;
  bool is_of_isaac = false;
};

const std::map<std::string, Format>& formats() {
  static const std::map<std::string, Format> all{
      {".npy", {"NumPy array", write_npy}},
      {".csv", {"CSV", write_csv}},
      {".mat3x4f", {"RobotecGPULidar", write_matrices}},
      {".usda", {"Isaac Sim 5 and later", write_prim, true}},
      {".json", {"Isaac Sim up to 4.5", write_profile, true}}};
  return all;
}

std::uint64_t scans_of(const sensor::ScanPattern& pattern, const PatternLength& length,
                       bool is_of_isaac, const std::string& name) {
  if (length.scans > 0 && length.seconds > 0.0)
    throw InputError("--scans", "is given together with --seconds", "give one of them");
  if (length.scans > 0) return length.scans;
  const double period = to_seconds(pattern.period());
  if (length.seconds > 0.0)
    return static_cast<std::uint64_t>(std::ceil(length.seconds / period - 1e-9));
  if (is_of_isaac) return 1;
  const std::uint64_t all = pattern.repeats_after();
  const double seconds = static_cast<double>(all) * period;
  if (all > 0 && seconds <= kLongestDefault + 1e-9) return all;
  throw InputError(name,
                   all == 0 ? std::string("has a pattern that never repeats")
                            : fmt::format("has a pattern that repeats after {:g} s", seconds),
                   "say how much of it to write: --seconds 10");
}

}  // namespace

PatternWritten write_pattern(const sensor::SensorConfig& sensor, const PatternLength& length,
                             const std::filesystem::path& file) {
  const auto format = formats().find(file.extension().string());
  if (format == formats().end()) {
    throw InputError(file.string(), "has an ending that is no format of a pattern",
                     "use .svg (a drawing), .npy, .csv, .mat3x4f (RobotecGPULidar), .usda (Isaac "
                     "Sim 5 and later) or .json (Isaac Sim up to 4.5)");
  }
  const auto pattern = make_pattern(sensor);
  const Part part{sensor, *pattern,
                  scans_of(*pattern, length, format->second.is_of_isaac, sensor.name)};
  if (part.scans > kMaxShots / pattern->beams_per_scan()) {
    throw InputError(file.string(), fmt::format("would have more than {} shots", kMaxShots),
                     "write fewer: --seconds 10");
  }
  if (format->first == ".usda" && sensor.rate_hz != std::round(sensor.rate_hz)) {
    throw InputError(
        file.string(),
        fmt::format("cannot state {:g} scans per second: Isaac Sim takes whole numbers",
                    sensor.rate_hz),
        "set rate_hz to a whole number, or write .json");
  }
  PartFile out(file);
  format->second.write(part, out);
  out.commit();
  return {format->second.name, part.scans, part.shots(), pattern->repeats_after()};
}

}  // namespace lidarena::stages
