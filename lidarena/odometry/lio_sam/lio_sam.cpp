// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/odometry/lio_sam/lio_sam.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <utility>

namespace lidarena::odometry::lio_sam {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr Time kImuMargin{10'000'000};  // the program uses IMU samples so long after a scan's end
constexpr double kLivoxInterval = 1.0;  // s, maximum age of the last keyframe
constexpr double kLevelWeight = 0.1;    // weight of the IMU's roll and pitch in fed back poses

/// `rotation` with roll and pitch pulled towards level, the constant orientation of a 6-axis IMU.
Matrix3d leveled(const Matrix3d& rotation) {
  const double roll = std::atan2(rotation(2, 1), rotation(2, 2));
  const double pitch = std::atan2(-rotation(2, 0), std::hypot(rotation(2, 1), rotation(2, 2)));
  const double yaw = std::atan2(rotation(1, 0), rotation(0, 0));
  return (Eigen::AngleAxisd(yaw, Vector3d::UnitZ()) *
          Eigen::AngleAxisd((1.0 - kLevelWeight) * pitch, Vector3d::UnitY()) *
          Eigen::AngleAxisd((1.0 - kLevelWeight) * roll, Vector3d::UnitX()))
      .toRotationMatrix();
}

}  // namespace

bool is_keyframe(const map::Keyframe& last, Time stamp, const Pose& world_from_lidar,
                 const Config& config) {
  const bool old =
      config.sensor == Sensor::kLivox && to_seconds(stamp - last.stamp) > kLivoxInterval;
  return old || map::has_moved(last, world_from_lidar, config.keyframe_translation_m,
                               config.keyframe_rotation_rad);
}

LioSam::LioSam(const Config& config, const LidarInfo& lidar, const ImuInfo& imu, Parallel parallel)
    : config_(config),
      body_from_lidar_(lidar.body_from_lidar),
      body_from_imu_(imu.body_from_imu),
      parallel_(std::move(parallel)),
      imu_(config, imu.body_from_imu.inverse() * lidar.body_from_lidar, 1.0 / lidar.rate_hz),
      world_from_lidar_(body_from_lidar_),
      last_match_(body_from_lidar_),
      odom_from_lidar_(body_from_lidar_),
      rule_(feature_rule(config)),
      voxels_{config.edge_voxel_size_m, config.surface_voxel_size_m},
      submap_(voxels_),
      loops_(config, parallel_) {}

ScanResult LioSam::track(const Scan& scan) {
  Within within{.end = end_in_message(scan), .track = {}};
  const ScanStatus waiting =
      scan.points.empty() ? ScanStatus::kTooFewPoints : ScanStatus::kInitializing;
  if (!imu_.is_ready(within.end)) return processed(scan.stamp, waiting, within, {});
  imu_.advance(scan.stamp);
  within.track = imu_.track(within.end + kImuMargin);
  if (!is_due(scan.stamp))
    return result_of({scan.stamp, predicted()}, keyframes_.empty() ? waiting : ScanStatus::kTracked,
                     within, {});

  last_processed_ = scan.stamp;
  ScanResult counted;
  map::Features features = features_of(scan, within, counted);
  if (features.surfaces.empty())
    return processed(scan.stamp, ScanStatus::kTooFewPoints, within, counted);
  const Pose before = world_from_lidar_;
  const Registration found = match(features, guess(), scan.stamp);
  counted.counters.degenerate_directions = found.degenerate_directions;
  counted.details.emplace_back("matches", found.matches);
  counted.details.emplace_back("iterations", found.iterations);
  counted.details.emplace_back("map_points", submap_.size());
  const ScanStatus status = status_of(found);
  if (status == ScanStatus::kDiverged)
    return result_of({scan.stamp, predicted()}, status, within, counted);
  world_from_lidar_ = found.map_from_lidar;
  feed_back(before, found);
  keep(scan.stamp, std::move(features));
  return processed(scan.stamp, status, within, counted);
}

bool LioSam::is_due(Time stamp) const {
  return !last_processed_ || to_seconds(stamp - *last_processed_) >= config_.process_interval_s;
}

map::Features LioSam::features_of(const Scan& scan, const Within& within,
                                  ScanResult& counted) const {
  const estimation::ImageLayout& layout = rule_.layout;
  const Pose imu_from_lidar = body_from_imu_.inverse() * body_from_lidar_;
  const estimation::RangeImage image = estimation::project(
      scan, deskewed(scan, within.track, within.end + kImuMargin, imu_from_lidar, layout), layout);
  const map::Features all = extract_features(image, rule_, parallel_);
  map::Features features = map::thinned(all, voxels_);
  counted.counters.points = image.pixels.size();
  counted.details.emplace_back("edges", all.edges.size());
  counted.details.emplace_back("surfaces", all.surfaces.size());
  counted.details.emplace_back("keypoints", features.edges.size() + features.surfaces.size());
  return features;
}

Pose LioSam::guess() {
  if (keyframes_.empty()) return world_from_lidar_;
  const std::optional<Pose> imu = imu_.odom_from_lidar();
  const std::optional<Pose> origin = guess_origin_;
  if (imu) guess_origin_ = imu;
  return imu && origin ? orthonormalized(world_from_lidar_ * origin->inverse() * *imu)
                       : world_from_lidar_;
}

Registration LioSam::match(const map::Features& features, const Pose& guess, Time stamp) {
  const bool enough = features.edges.size() > static_cast<std::size_t>(config_.min_edges) &&
                      features.surfaces.size() > static_cast<std::size_t>(config_.min_surfaces);
  if (keyframes_.empty() || !enough) return {.map_from_lidar = guess};
  submap_.follow(keyframes_, stamp,
                 {.radius_m = config_.submap_radius_m,
                  .keyframe_spacing_m = config_.submap_keyframe_spacing_m});
  const Registration found = register_features(features, submap_, guess, config_.sensor, parallel_);
  last_match_ = found.map_from_lidar;
  return found;
}

ScanStatus LioSam::status_of(const Registration& found) const {
  if (!found.map_from_lidar.matrix().allFinite()) return ScanStatus::kDiverged;
  if (keyframes_.empty()) return ScanStatus::kInitializing;
  if (found.iterations == 0) return ScanStatus::kTooFewPoints;
  return found.degenerate_directions > 0 ? ScanStatus::kDegenerate : ScanStatus::kTracked;
}

void LioSam::feed_back(const Pose& before, const Registration& found) {
  if (found.iterations > 0) degenerate_ = found.degenerate_directions > 0;
  // A scan without enough features does not move last_match_: the motion is then zero or back.
  odom_from_lidar_ = orthonormalized(odom_from_lidar_ * before.inverse() * last_match_);
  Pose measured = odom_from_lidar_;
  if (config_.sensor == Sensor::kLivox) {
    const Matrix3d body_from_lidar = body_from_lidar_.linear();
    measured.linear() = leveled(measured.linear() * body_from_lidar.transpose()) * body_from_lidar;
  }
  imu_.send(measured, degenerate_);
}

void LioSam::keep(Time stamp, map::Features features) {
  if (!keyframes_.empty() && !is_keyframe(keyframes_.back(), stamp, world_from_lidar_, config_))
    return;
  const Pose previous_from_this =
      keyframes_.empty() ? world_from_lidar_
                         : keyframes_.back().world_from_lidar.inverse() * world_from_lidar_;
  const Pose lidar_from_body = body_from_lidar_.inverse();
  poses_.add_anchor(stamp, keyframes_.empty()
                               ? previous_from_this * lidar_from_body
                               : body_from_lidar_ * previous_from_this * lidar_from_body);
  keyframes_.push_back({stamp, world_from_lidar_, std::move(features), 0});
  if (!loops_.close(keyframes_, previous_from_this)) return;
  map::move_to(loops_.poses(), keyframes_);
  const Pose corrected = loops_.poses().back();
  world_from_odom_ = orthonormalized(corrected * world_from_lidar_.inverse() * world_from_odom_);
  world_from_lidar_ = corrected;
}

ScanResult LioSam::processed(Time stamp, ScanStatus status, const Within& within,
                             ScanResult counted) {
  const bool registered =
      status != ScanStatus::kTooFewPoints || counted.counters.degenerate_directions;
  const Pose world_from_lidar = registered ? world_from_lidar_ : predicted();
  const Pose anchor_from_lidar =
      keyframes_.empty()
          ? world_from_lidar
          : body_from_lidar_ * keyframes_.back().world_from_lidar.inverse() * world_from_lidar;
  poses_.add(stamp, anchor_from_lidar * body_from_lidar_.inverse());
  return result_of({stamp, world_from_lidar}, status, within, std::move(counted));
}

ScanResult LioSam::result_of(const StampedPose& lidar, ScanStatus status, const Within& within,
                             ScanResult counted) const {
  ScanResult result = std::move(counted);
  const Pose world_from_body = orthonormalized(lidar.world_from_body * body_from_lidar_.inverse());
  result.estimate = {lidar.stamp, world_from_body};
  result.status = status;
  result.world_from_odom = world_from_odom_;
  result.counters.imu_restarts = imu_.resets();
  result.counters.loops = loops_.accepted();
  for (const auto& [name, value] : {std::pair("imu_gap_s", imu_.longest_gap_s()),
                                    {"imu_refused", static_cast<double>(imu_.refused())},
                                    {"accel_scale", imu_.accel_scale()},
                                    {"keyframes", static_cast<double>(keyframes_.size())},
                                    {"loops_tried", static_cast<double>(loops_.tried())}})
    result.details.emplace_back(name, value);
  if (status != ScanStatus::kDiverged)
    result.motion =
        estimation::motion_along(within.track, lidar.stamp, within.end, lidar.stamp,
                                 world_from_body * body_from_imu_, body_from_imu_.inverse());
  return result;
}

Trajectory LioSam::trajectory() const {
  std::vector<Pose> bodies;
  for (const map::Keyframe& keyframe : keyframes_)
    bodies.push_back(keyframe.world_from_lidar * body_from_lidar_.inverse());
  return Trajectory(poses_.placed(bodies), "lio_sam");
}

MemoryUse LioSam::memory() const {
  return {.map = map::memory_bytes(keyframes_) + submap_.memory_bytes(),
          .backlog = imu_.memory_bytes(),
          .other = poses_.memory_bytes() + loops_.memory_bytes()};
}

}  // namespace lidarena::odometry::lio_sam
