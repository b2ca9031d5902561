// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/base/pose.hpp"
#include "lidarena/base/time.hpp"
#include "lidarena/estimation/pose_graph.hpp"
#include "lidarena/loop/config.hpp"
#include "lidarena/loop/icp.hpp"
#include "lidarena/loop/place_descriptor.hpp"

namespace lidarena {

/// What became of a place that might be one seen before.
enum class LoopVerdict {
  kAccepted,
  kWaiting,        ///< good, but no other loop agrees yet
  kTooFewPoints,   ///< of one of the clouds
  kNotConverged,   ///< ICP found no rest
  kPoorFit,        ///< points lie too far from each other
  kLittleOverlap,  ///< too much of the new place is not at the old one
  kUnconstrained,  ///< the clouds can slide along each other
  kBeyondDrift,    ///< the odometry cannot be that wrong: another place that looks the same
};
const char* to_string(LoopVerdict verdict);

/// A loop that was tried.
struct LoopRecord {
  std::size_t first = 0;   ///< keyframe seen before
  std::size_t second = 0;  ///< keyframe that was new
  bool by_appearance = false;
  LoopVerdict verdict = LoopVerdict::kTooFewPoints;
  Pose first_from_second = Pose::Identity();  ///< as the clouds say
  double fitness = 0.0;                       ///< m^2
  double overlap = 0.0;
  double constraint = 0.0;
  double shift = 0.0;  ///< m, by which the loop contradicts the poses at the time
  double turn = 0.0;   ///< rad, likewise
  double way = 0.0;    ///< m of measured motion between the two
};

/// The points of a keyframe, in its own frame (m).
using KeyframeCloud = std::function<std::span<const Eigen::Vector3f>(std::size_t keyframe)>;

/// Finds places that a path of keyframes comes back to and bends the path so that they meet:
/// candidates by distance (LIO-SAM, section III-C.4) and by looks, verification by ICP and by what
/// the odometry can have drifted, then a pose graph. Knows nothing of how the path was estimated.
/// Searches are triggered by the number of keyframes, so the same input gives the same bits; what
/// one finds is tried one by one, as keyframes come.
class LoopCloser {
 public:
  LoopCloser(const LoopConfig& config, Parallel parallel)
      : config_(config), parallel_(std::move(parallel)) {}

  /// The next keyframe, where it stands when seen from the one before (for the first: from the
  /// world), and access to the points of all so far. Whether poses() have changed beyond it.
  bool add(Time stamp, const Pose& previous_from_this, const KeyframeCloud& cloud);

  /// world_from_keyframe.
  const std::vector<Pose>& poses() const { return graph_.nodes; }
  const std::vector<LoopRecord>& records() const { return records_; }
  std::size_t accepted() const { return accepted_.size(); }
  std::uint64_t memory_bytes() const;

 private:
  struct Candidate {
    std::size_t keyframe = 0;
    std::size_t seen_from = 0;  ///< the keyframe that was new
    double way = 0.0;           ///< m of measured motion between the two
    bool by_appearance = false;
    Pose guess = Pose::Identity();  ///< candidate from new keyframe
  };
  std::size_t last() const { return graph_.nodes.size() - 1; }
  /// The next candidate: one a keyframe, so that none of them takes long.
  bool try_next(const KeyframeCloud& cloud);
  std::vector<Candidate> candidates(const std::vector<double>& ways) const;
  void add_nearest(const std::vector<double>& ways, std::vector<Candidate>& found) const;
  void add_alike(const std::vector<double>& ways, std::vector<Candidate>& found) const;
  bool may_close(std::size_t keyframe, const std::vector<double>& ways) const;
  std::vector<Eigen::Vector3f> around(std::size_t keyframe, std::size_t before, std::size_t after,
                                      const KeyframeCloud& cloud) const;
  LoopRecord verify(const Candidate& candidate, const KeyframeCloud& cloud) const;
  /// Whether the two places lie further apart than drift can have brought them.
  bool is_out_of_reach(const LoopRecord& loop) const;
  LoopVerdict judge(const IcpResult& icp, const LoopRecord& loop) const;
  /// Measured meters from each keyframe to the last one, by the shortest way through known loops.
  std::vector<double> ways_to_last() const;
  bool agree(const LoopRecord& a, const LoopRecord& b) const;
  /// Those waiting that agree with the last record, and itself, if they are enough to be believed.
  std::vector<LoopRecord> believed();
  void close(const std::vector<LoopRecord>& loops);

  LoopConfig config_;
  Parallel parallel_;
  std::vector<Time> stamps_;
  std::vector<double> steps_;  ///< m, from the keyframe before
  std::vector<PlaceDescriptor> descriptors_;
  PoseGraph graph_;
  std::vector<Candidate> due_;  ///< of the last search, not tried yet
  std::vector<LoopRecord> records_;
  std::vector<LoopRecord> waiting_;
  std::vector<LoopRecord> accepted_;
};

}  // namespace lidarena
