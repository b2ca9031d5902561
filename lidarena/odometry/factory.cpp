// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/factory.hpp"

#include <algorithm>
#include <utility>

#include "lidarena/base/config_schema.hpp"
#include "lidarena/odometry/arena_lio/arena_lio.hpp"
#include "lidarena/odometry/arena_lo/arena_lo.hpp"
#include "lidarena/odometry/ct_icp/ct_icp.hpp"
#include "lidarena/odometry/fast_lio2/fast_lio2.hpp"
#include "lidarena/odometry/kiss_icp/kiss_icp.hpp"
#include "lidarena/odometry/kiss_icp_head/kiss_icp_head.hpp"
#include "lidarena/odometry/lio_sam/lio_sam.hpp"
#include "lidarena/odometry/with_loop.hpp"

namespace lidarena::odometry {

namespace {

/// Applies the file to the preset `config`, then the overrides.
template <class Config>
Config configured(Config config, const OdometryRequest& request) {
  if (!request.config_file.empty()) read_config(ConfigNode::load(request.config_file), config);
  for (const std::string& assignment : request.overrides) set_field(config, assignment);
  return config;
}

/// Configuration of an odometry and of the loop closure around it.
template <class Inner>
struct LoopedConfig {
  Inner odometry;
  WithLoopConfig loops;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("odometry", self.odometry, "", "settings of the odometry itself");
    v("loops", self.loops, "", "settings of the loop closure around it");
  }
};

const ImuInfo& imu_for(const char* algorithm, const Rig& rig, const LidarInfo& lidar) {
  if (const ImuInfo* imu = rig.imu_beside(lidar)) return *imu;
  throw InputError("rig", std::string("it has no IMU, but ") + algorithm + " needs one",
                   "use arena_lo, kiss_icp or ct_icp, which need none");
}

template <class Config>
struct Preset {
  std::string name;
  Config (*make)(const LidarInfo&);
  int parts = 1;  ///< scans in which each sweep is handed over
};
template <class Config>
using PresetTable = std::vector<Preset<Config>>;

/// One struct for each algorithm: its configuration, its presets (the default first; one without a
/// name if there is no choice) and how to build it.
struct Kiss {
  using Config = kiss_icp::Config;
  static PresetTable<Config> presets() {
    return {{"indoor", kiss_icp::indoor},
            {"published", kiss_icp::published},
            {"tuned", kiss_icp::tuned, 2}};
  }
  static std::unique_ptr<Odometry> build(const Config& config, const Rig&, const LidarInfo& lidar,
                                         const Parallel& parallel) {
    return std::make_unique<kiss_icp::KissIcp>(config, lidar, parallel);
  }
};

struct KissHead {
  using Config = kiss_icp_head::Config;
  static PresetTable<Config> presets() { return {{"", kiss_icp_head::published}}; }
  static std::unique_ptr<Odometry> build(const Config& config, const Rig&, const LidarInfo& lidar,
                                         const Parallel& parallel) {
    return std::make_unique<kiss_icp_head::KissIcpHead>(config, lidar, parallel);
  }
};

struct Ct {
  using Config = ct_icp::Config;
  static PresetTable<Config> presets() {
    return {{"indoor", ct_icp::indoor}, {"published", ct_icp::published}, {"tuned", ct_icp::tuned}};
  }
  static std::unique_ptr<Odometry> build(const Config& config, const Rig&, const LidarInfo& lidar,
                                         const Parallel& parallel) {
    return std::make_unique<ct_icp::CtIcp>(config, lidar, parallel);
  }
};

struct FastLio {
  using Config = fast_lio2::Config;
  static PresetTable<Config> presets() {
    return {{"indoor", fast_lio2::indoor},
            {"published", fast_lio2::published},
            {"tuned", fast_lio2::tuned}};
  }
  static std::unique_ptr<Odometry> build(const Config& config, const Rig& rig,
                                         const LidarInfo& lidar, const Parallel& parallel) {
    const ImuInfo& imu = imu_for("fast_lio2", rig, lidar);
    return std::make_unique<fast_lio2::FastLio2>(config, lidar, imu, parallel);
  }
};

struct LioSam {
  using Config = lio_sam::Config;
  static PresetTable<Config> presets() {
    return {{"indoor", lio_sam::indoor},
            {"published", lio_sam::published},
            {"tuned", lio_sam::tuned, 2}};
  }
  static std::unique_ptr<Odometry> build(const Config& config, const Rig& rig,
                                         const LidarInfo& lidar, const Parallel& parallel) {
    const ImuInfo& imu = imu_for("lio_sam", rig, lidar);
    return std::make_unique<lio_sam::LioSam>(config, lidar, imu, parallel);
  }
};

struct LioSamLc : LioSam {
  template <Config (*without_loops)(const LidarInfo&)>
  static Config with_loops(const LidarInfo& lidar) {
    Config config = without_loops(lidar);
    config.loop_closure = true;
    return config;
  }
  static PresetTable<Config> presets() {
    return {{"indoor", with_loops<lio_sam::indoor>},
            {"published", with_loops<lio_sam::published>},
            {"tuned", with_loops<lio_sam::tuned>, 2}};
  }
};

/// Settings of the loop closure around an odometry that drifts less than the defaults of LoopConfig
/// say: somewhat more than what it drifts in the development flights.
WithLoopConfig loops_for_drift(double m_per_m, double rad_per_m) {
  WithLoopConfig config;
  config.loop.translation_drift_m_per_m = m_per_m;
  config.loop.rotation_drift_rad_per_m = rad_per_m;
  return config;
}

struct ArenaLo {
  using Config = arena_lo::Config;
  static WithLoopConfig loops() { return loops_for_drift(5e-3, 5e-4); }
  static PresetTable<Config> presets() { return {{"", arena_lo::settings_for}}; }
  static std::unique_ptr<Odometry> build(const Config& config, const Rig&, const LidarInfo& lidar,
                                         const Parallel& parallel) {
    return std::make_unique<arena_lo::ArenaLo>(config, lidar, parallel);
  }
};

struct ArenaLio {
  using Config = arena_lio::Config;
  static WithLoopConfig loops() { return loops_for_drift(2e-3, 2e-4); }
  static PresetTable<Config> presets() { return {{"", arena_lio::settings_for}}; }
  static std::unique_ptr<Odometry> build(const Config& config, const Rig& rig,
                                         const LidarInfo& lidar, const Parallel& parallel) {
    const ImuInfo& imu = imu_for("arena_lio", rig, lidar);
    return std::make_unique<arena_lio::ArenaLio>(config, lidar, imu, parallel);
  }
};

std::string listed(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

template <class Maker>
std::vector<std::string> preset_names() {
  std::vector<std::string> names;
  for (const auto& preset : Maker::presets()) {
    if (!preset.name.empty()) names.push_back(preset.name);
  }
  return names;
}

/// What a preset of version 0.1.0 is today.
std::string successor_of(const std::string& algorithm, const std::string& preset) {
  if (!algorithm.starts_with("kiss_icp")) return "";
  if (preset == "head") return "it is the method kiss_icp_head";
  if (preset == "original")
    return "nearest to it is the preset published, whose de-skewing is off as shipped";
  return preset == "improved" ? "it was removed; arena_lo is more accurate" : "";
}

template <class Maker>
Preset<typename Maker::Config> preset_of(const OdometryRequest& request) {
  for (const auto& preset : Maker::presets()) {
    if (preset.name == request.preset || request.preset.empty()) return preset;
  }
  throw InputError("preset", request.algorithm + " has no preset '" + request.preset + "'");
}

template <class Maker>
typename Maker::Config preset_config(const OdometryRequest& request, const LidarInfo& lidar) {
  return preset_of<Maker>(request).make(lidar);
}

template <class Maker>
typename Maker::Config config_of(const OdometryRequest& request, const LidarInfo& lidar) {
  return configured(preset_config<Maker>(request, lidar), request);
}

template <class Maker>
MadeOdometry make(const OdometryRequest& request, const Rig& rig, const LidarInfo& lidar,
                  const Parallel& parallel) {
  const auto config = config_of<Maker>(request, lidar);
  return {Maker::build(config, rig, lidar, parallel), to_json(config)};
}

/// The preset of `Maker` with the settings of the loop closure around it.
template <class Maker>
LoopedConfig<typename Maker::Config> with_loops(typename Maker::Config odometry) {
  if constexpr (requires { Maker::loops(); }) return {std::move(odometry), Maker::loops()};
  return {std::move(odometry), {}};
}

template <class Maker>
LoopedConfig<typename Maker::Config> config_with_loop(const OdometryRequest& request,
                                                      const LidarInfo& lidar) {
  return configured(with_loops<Maker>(preset_config<Maker>(request, lidar)), request);
}

template <class Maker>
MadeOdometry make_with_loop(const OdometryRequest& request, const Rig& rig, const LidarInfo& lidar,
                            const Parallel& parallel) {
  const auto config = config_with_loop<Maker>(request, lidar);
  return {std::make_unique<WithLoop>(Maker::build(config.odometry, rig, lidar, parallel),
                                     config.loops, parallel),
          to_json(config)};
}

/// The default preset for a LiDAR of which nothing is known: the defaults in the schema. (Ranges
/// follow the LiDAR's.)
template <class Maker>
typename Maker::Config default_config() {
  return Maker::presets().front().make(LidarInfo{});
}

template <class Maker>
Json schema(const AlgorithmInfo& info) {
  return schema_document(info.name + ": " + info.summary, default_config<Maker>());
}

template <class Maker>
Json schema_with_loop(const AlgorithmInfo& info) {
  return schema_document(info.name + ": " + info.summary,
                         with_loops<Maker>(default_config<Maker>()));
}

struct Algorithm {
  AlgorithmInfo info;
  MadeOdometry (*make)(const OdometryRequest&, const Rig&, const LidarInfo&, const Parallel&);
  Json (*schema)(const AlgorithmInfo&);
  Json (*config)(const OdometryRequest&, const LidarInfo&);
  int (*parts)(const OdometryRequest&);
};

template <class Maker>
int parts_of_preset(const OdometryRequest& request) {
  return preset_of<Maker>(request).parts;
}

template <class Maker>
Algorithm plain(std::string name, std::string summary, bool needs_imu) {
  return {{std::move(name), std::move(summary), preset_names<Maker>(), needs_imu},
          make<Maker>,
          schema<Maker>,
          [](const OdometryRequest& request, const LidarInfo& lidar) {
            return to_json(config_of<Maker>(request, lidar));
          },
          parts_of_preset<Maker>};
}

template <class Maker>
Algorithm looped(std::string name, std::string summary, bool needs_imu) {
  return {{std::move(name), std::move(summary), preset_names<Maker>(), needs_imu},
          make_with_loop<Maker>,
          schema_with_loop<Maker>,
          [](const OdometryRequest& request, const LidarInfo& lidar) {
            return to_json(config_with_loop<Maker>(request, lidar));
          },
          parts_of_preset<Maker>};
}

Algorithm with_several_lidars(Algorithm algorithm) {
  algorithm.info.takes_several_lidars = true;
  return algorithm;
}

std::vector<Algorithm> algorithms() {
  return {
      plain<Kiss>("kiss_icp", "LiDAR only: point-to-point ICP against a voxel map (Vizzo 2023)",
                  false),
      plain<KissHead>("kiss_icp_head", "LiDAR only: KISS-ICP as its program of late 2025", false),
      plain<Ct>("ct_icp", "LiDAR only: elastic scans to planes of a voxel map (Dellenbach 2022)",
                false),
      plain<FastLio>("fast_lio2",
                     "LiDAR and IMU: iterated Kalman filter on points and planes (Xu 2022)", true),
      plain<LioSam>("lio_sam",
                    "LiDAR and IMU: edges and planes, smoothed in a factor graph (Shan 2020)",
                    true),
      plain<LioSamLc>("lio_sam_lc", "LIO-SAM with its loop closure", true),
      plain<ArenaLo>("arena_lo", "our own, LiDAR only: Kalman smoother over slices of a scan",
                     false),
      with_several_lidars(
          plain<ArenaLio>("arena_lio", "our own, LiDAR and IMU: iterated Kalman filter", true)),
      looped<Kiss>("kiss_icp+loop", "KISS-ICP with our loop closure around it", false),
      looped<KissHead>("kiss_icp_head+loop", "KISS-ICP of 2025 with our loop closure around it",
                       false),
      looped<FastLio>("fast_lio2+loop", "FAST-LIO2 with our loop closure around it", true),
      looped<ArenaLo>("arena_lo+loop", "arena_lo with our loop closure around it", false),
      with_several_lidars(
          looped<ArenaLio>("arena_lio+loop", "arena_lio with our loop closure around it", true)),
  };
}

InputError no_such_algorithm(const std::string& name, const std::vector<std::string>& names) {
  const std::string nearest = nearest_word(name, names);
  return {"algorithm", "there is no '" + name + "'",
          nearest.empty() ? "use one of " + listed(names) : "did you mean '" + nearest + "'?"};
}

/// The algorithm that is asked for, which has the preset that is asked for.
Algorithm chosen_algorithm(const OdometryRequest& request) {
  std::vector<std::string> names;
  for (Algorithm& algorithm : algorithms()) {
    const std::vector<std::string>& presets = algorithm.info.presets;
    names.push_back(algorithm.info.name);
    if (names.back() != request.algorithm) continue;
    if (request.preset.empty() || std::ranges::find(presets, request.preset) != presets.end())
      return std::move(algorithm);
    std::string remedy = successor_of(request.algorithm, request.preset);
    if (presets.empty()) remedy = "it has none: leave it out";
    if (remedy.empty()) remedy = "use one of " + listed(presets);
    throw InputError("preset", request.algorithm + " has no preset '" + request.preset + "'",
                     remedy);
  }
  throw no_such_algorithm(request.algorithm, names);
}

const LidarInfo& chosen_lidar(const Rig& rig, const std::string& lidar_id) {
  if (const LidarInfo* lidar = rig.find_lidar(lidar_id)) return *lidar;
  std::vector<std::string> ids;
  for (const LidarInfo& lidar : rig.lidars) ids.push_back(lidar.id);
  if (ids.empty()) throw InputError("rig", "it has no LiDAR", "an odometry needs one");
  if (lidar_id.empty())
    throw InputError("rig", "it has several LiDARs", "choose one of " + listed(ids));
  throw InputError("rig", "it has no LiDAR '" + lidar_id + "'", "use one of " + listed(ids));
}

}  // namespace

std::vector<AlgorithmInfo> list_algorithms() {
  std::vector<AlgorithmInfo> infos;
  for (const Algorithm& algorithm : algorithms()) infos.push_back(algorithm.info);
  return infos;
}

Json algorithm_schema(const std::string& name) {
  for (const Algorithm& algorithm : algorithms()) {
    if (algorithm.info.name == name) return algorithm.schema(algorithm.info);
  }
  throw InputError("algorithm", "there is no '" + name + "'");
}

OdometryRequest with_default_preset(OdometryRequest request) {
  for (const Algorithm& algorithm : algorithms()) {
    const AlgorithmInfo& info = algorithm.info;
    if (info.name == request.algorithm && request.preset.empty() && !info.presets.empty())
      request.preset = info.presets.front();
  }
  return request;
}

void check_algorithm(const OdometryRequest& request) { chosen_algorithm(request); }

void check_takes_several_lidars(const std::string& algorithm) {
  if (chosen_algorithm({.algorithm = algorithm}).info.takes_several_lidars) return;
  std::vector<std::string> names;
  for (const AlgorithmInfo& info : list_algorithms())
    if (info.takes_several_lidars) names.push_back(info.name);
  throw InputError("also", algorithm + " takes the scans of one LiDAR alone",
                   "leave it out, or use one of " + listed(names));
}

int parts_of(const OdometryRequest& request) { return chosen_algorithm(request).parts(request); }

Json configuration_of(const OdometryRequest& request, const LidarInfo& lidar) {
  return chosen_algorithm(request).config(request, lidar);
}

MadeOdometry make_odometry(const OdometryRequest& request, const Rig& rig,
                           const std::string& lidar_id, const Parallel& parallel) {
  const Algorithm algorithm = chosen_algorithm(request);
  return algorithm.make(request, rig, chosen_lidar(rig, lidar_id), parallel);
}

}  // namespace lidarena::odometry
