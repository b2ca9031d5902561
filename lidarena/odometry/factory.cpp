// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/factory.hpp"

#include "lidarena/odometry/ct_icp/ct_icp.hpp"
#include "lidarena/odometry/fast_lio2/fast_lio2.hpp"
#include "lidarena/odometry/kiss_icp/kiss_icp.hpp"

namespace lidarena {

namespace {

/// Preset, then file, then overrides.
template <class Config>
Config configured(Config config, const OdometryRequest& request) {
  if (!request.config_file.empty()) read_config(ConfigNode::load(request.config_file), config);
  for (const std::string& assignment : request.overrides) set_field(config, assignment);
  return config;
}

MadeOdometry make_kiss_icp(const OdometryRequest& request, const Rig&, const LidarInfo& lidar,
                           const Parallel& parallel) {
  const auto config = configured(kiss_icp::preset(request.preset, lidar), request);
  return {std::make_unique<kiss_icp::KissIcp>(config, lidar, parallel), to_json(config)};
}

MadeOdometry make_ct_icp(const OdometryRequest& request, const Rig&, const LidarInfo& lidar,
                         const Parallel& parallel) {
  const auto config = configured(ct_icp::preset(request.preset, lidar), request);
  return {std::make_unique<ct_icp::CtIcp>(config, lidar, parallel), to_json(config)};
}

MadeOdometry make_fast_lio2(const OdometryRequest& request, const Rig& rig, const LidarInfo& lidar,
                            const Parallel& parallel) {
  const auto config = configured(fast_lio2::preset(request.preset, lidar), request);
  const ImuInfo* imu = rig.imu_beside(lidar);
  if (imu == nullptr) {
    throw InputError("rig", "it has no IMU, which fast_lio2 needs", "use kiss_icp without one");
  }
  return {std::make_unique<fast_lio2::FastLio2>(config, lidar, *imu, parallel), to_json(config)};
}

struct Algorithm {
  AlgorithmInfo info;
  MadeOdometry (*make)(const OdometryRequest&, const Rig&, const LidarInfo&, const Parallel&);
};

std::vector<Algorithm> algorithms() {
  return {
      {{"kiss_icp", "LiDAR only: point-to-point ICP against a voxel map (Vizzo et al. 2023)",
        kiss_icp::preset_names(), false},
       make_kiss_icp},
      {{"ct_icp", "LiDAR only: elastic scans to planes of a voxel map (Dellenbach et al. 2022)",
        ct_icp::preset_names(), false},
       make_ct_icp},
      {{"fast_lio2", "LiDAR and IMU: iterated Kalman filter on points and planes (Xu et al. 2022)",
        fast_lio2::preset_names(), true},
       make_fast_lio2},
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

}  // namespace lidarena
