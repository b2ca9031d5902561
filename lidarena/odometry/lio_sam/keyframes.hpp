// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "lidarena/base/pose.hpp"
#include "lidarena/base/time.hpp"
#include "lidarena/odometry/lio_sam/config.hpp"
#include "lidarena/odometry/lio_sam/features.hpp"
#include "lidarena/odometry/lio_sam/registration.hpp"

namespace lidarena::lio_sam {

/// A scan that is kept.
struct Keyframe {
  Time stamp{0};
  Pose world_from_lidar = Pose::Identity();
  Features features;  ///< thinned, LiDAR frame
};

/// Whether a scan at `stamp` and `world_from_lidar` should be one, given the last one.
bool is_keyframe(const Keyframe& last, Time stamp, const Pose& world_from_lidar,
                 const Config& config);

/// Averages the scans from one keyframe to the next into it.
class KeyframeMerger {
 public:
  /// A new keyframe begins with these features.
  void begin(const Features& features);
  /// Adds a scan seen from the keyframe. Whether the keyframe's features should be renewed: when
  /// the scans have become four times as many, so that a map at rest does not change all the time.
  bool add(const Features& features, const Pose& keyframe_from_lidar, const Config& config);
  /// All scans so far, averaged.
  Features merged(const Config& config) const { return thinned(all_, config); }

 private:
  Features all_;
  int scans_ = 0;
};

/// Indices of the keyframes to match with at `now` around `position` (m), in order: one a cell of
/// those within the radius, the oldest (so that drift does not creep in), and the recent ones.
std::vector<std::uint32_t> surrounding(const std::vector<Keyframe>& keyframes,
                                       const Eigen::Vector3d& position, Time now,
                                       const Config& config);

/// The features of some keyframes in one map, rebuilt when others are asked for.
class Submap {
 public:
  /// `revision` grows whenever keyframes have been moved or renewed.
  void select(const std::vector<Keyframe>& keyframes, std::vector<std::uint32_t> chosen,
              std::uint64_t revision, const Config& config);
  const FeatureMap& map() const { return map_; }
  std::size_t size() const { return map_.edges.size() + map_.surfaces.size(); }
  std::uint64_t memory_bytes() const;

 private:
  FeatureMap map_;
  std::vector<std::uint32_t> chosen_;
  std::uint64_t revision_ = 0;
};

}  // namespace lidarena::lio_sam
