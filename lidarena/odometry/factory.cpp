// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/factory.hpp"

#include "lidarena/base/config_schema.hpp"
#include "lidarena/odometry/ct_icp/ct_icp.hpp"
#include "lidarena/odometry/fast_lio2/fast_lio2.hpp"
#include "lidarena/odometry/kiss_icp/kiss_icp.hpp"
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

const ImuInfo& imu_for(const std::string& algorithm, const Rig& rig, const LidarInfo& lidar) {
  if (const ImuInfo* imu = rig.imu_beside(lidar)) return *imu;
  throw InputError("rig", "it has no IMU, but " + algorithm + " needs one",
                   "use kiss_icp or ct_icp, which need none");
}

/// One struct for each algorithm: its configuration, its presets and how to build it.
struct Kiss {
  using Config = kiss_icp::Config;
  static constexpr auto preset = kiss_icp::preset;
  static std::unique_ptr<Odometry> build(const Config& config, const Rig&, const LidarInfo& lidar,
                                         const Parallel& parallel) {
    return std::make_unique<kiss_icp::KissIcp>(config, lidar, parallel);
  }
};

struct Ct {
  using Config = ct_icp::Config;
  static constexpr auto preset = ct_icp::preset;
  static std::unique_ptr<Odometry> build(const Config& config, const Rig&, const LidarInfo& lidar,
                                         const Parallel& parallel) {
    return std::make_unique<ct_icp::CtIcp>(config, lidar, parallel);
  }
};

struct FastLio {
  using Config = fast_lio2::Config;
  static constexpr auto preset = fast_lio2::preset;
  static std::unique_ptr<Odometry> build(const Config& config, const Rig& rig,
                                         const LidarInfo& lidar, const Parallel& parallel) {
    const ImuInfo& imu = imu_for("fast_lio2", rig, lidar);
    return std::make_unique<fast_lio2::FastLio2>(config, lidar, imu, parallel);
  }
};

struct LioSam {
  using Config = lio_sam::Config;
  static constexpr auto preset = lio_sam::preset;
  static std::unique_ptr<Odometry> build(const Config& config, const Rig& rig,
                                         const LidarInfo& lidar, const Parallel& parallel) {
    const ImuInfo& imu = imu_for("lio_sam", rig, lidar);
    return std::make_unique<lio_sam::LioSam>(config, lidar, imu, parallel);
  }
};

struct LioSamLc : LioSam {
  static Config preset(const std::string& name, const LidarInfo& lidar) {
    Config config = lio_sam::preset(name, lidar);
    config.loop_closure = true;
    return config;
  }
};

template <class Maker>
MadeOdometry make(const OdometryRequest& request, const Rig& rig, const LidarInfo& lidar,
                  const Parallel& parallel) {
  const auto config = configured(Maker::preset(request.preset, lidar), request);
  return {Maker::build(config, rig, lidar, parallel), to_json(config)};
}

template <class Maker>
MadeOdometry make_with_loop(const OdometryRequest& request, const Rig& rig, const LidarInfo& lidar,
                            const Parallel& parallel) {
  const LoopedConfig<typename Maker::Config> defaults{Maker::preset(request.preset, lidar), {}};
  const auto config = configured(defaults, request);
  return {std::make_unique<WithLoop>(Maker::build(config.odometry, rig, lidar, parallel),
                                     config.loops, parallel),
          to_json(config)};
}

/// The default preset for a LiDAR of which nothing is known: the defaults in the schema. (Ranges
/// follow the LiDAR's.)
template <class Maker>
typename Maker::Config default_config(const AlgorithmInfo& info) {
  return Maker::preset(info.presets.front(), LidarInfo{});
}

template <class Maker>
Json schema(const AlgorithmInfo& info) {
  return schema_document(info.name + ": " + info.summary, default_config<Maker>(info));
}

template <class Maker>
Json schema_with_loop(const AlgorithmInfo& info) {
  const LoopedConfig<typename Maker::Config> config{default_config<Maker>(info), {}};
  return schema_document(info.name + ": " + info.summary, config);
}

struct Algorithm {
  AlgorithmInfo info;
  MadeOdometry (*make)(const OdometryRequest&, const Rig&, const LidarInfo&, const Parallel&);
  Json (*schema)(const AlgorithmInfo&);
};

std::vector<Algorithm> algorithms() {
  return {
      {{"kiss_icp", "LiDAR only: point-to-point ICP against a voxel map (Vizzo et al. 2023)",
        kiss_icp::preset_names(), false},
       make<Kiss>,
       schema<Kiss>},
      {{"ct_icp", "LiDAR only: elastic scans to planes of a voxel map (Dellenbach et al. 2022)",
        ct_icp::preset_names(), false},
       make<Ct>,
       schema<Ct>},
      {{"fast_lio2", "LiDAR and IMU: iterated Kalman filter on points and planes (Xu et al. 2022)",
        fast_lio2::preset_names(), true},
       make<FastLio>,
       schema<FastLio>},
      {{"lio_sam", "LiDAR and IMU: edges and planes, smoothed in a factor graph (Shan et al. 2020)",
        lio_sam::preset_names(), true},
       make<LioSam>,
       schema<LioSam>},
      {{"lio_sam_lc", "LIO-SAM with loop closure", lio_sam::preset_names(), true},
       make<LioSamLc>,
       schema<LioSamLc>},
      {{"kiss_icp+loop", "KISS-ICP with loop closure around it", kiss_icp::preset_names(), false},
       make_with_loop<Kiss>,
       schema_with_loop<Kiss>},
      {{"fast_lio2+loop", "FAST-LIO2 with loop closure around it", fast_lio2::preset_names(), true},
       make_with_loop<FastLio>,
       schema_with_loop<FastLio>},
  };
}

std::string listed(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
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

MadeOdometry make_odometry(const OdometryRequest& request, const Rig& rig,
                           const std::string& lidar_id, const Parallel& parallel) {
  std::vector<std::string> names;
  for (const Algorithm& algorithm : algorithms()) {
    if (algorithm.info.name == request.algorithm)
      return algorithm.make(request, rig, chosen_lidar(rig, lidar_id), parallel);
    names.push_back(algorithm.info.name);
  }
  const std::string nearest = nearest_word(request.algorithm, names);
  throw InputError(
      "algorithm", "there is no '" + request.algorithm + "'",
      nearest.empty() ? "use one of " + listed(names) : "did you mean '" + nearest + "'?");
}

}  // namespace lidarena::odometry
