// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <span>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/base/pose.hpp"
#include "lidarena/base/time.hpp"
#include "lidarena/estimation/pose_graph.hpp"
#include "lidarena/loop/config.hpp"
#include "lidarena/loop/icp.hpp"
#include "lidarena/loop/place_descriptor.hpp"

namespace lidarena::loop {

/// Result of the verification of a loop candidate.
enum class LoopVerdict {
  kAccepted,
  kWaiting,        ///< verified, but no other loop agrees yet
  kTooFewPoints,   ///< in one of the clouds
  kNotConverged,   ///< ICP did not converge
  kPoorFit,        ///< corresponding points are too far from each other
  kLittleOverlap,  ///< too few points of the new place overlap with the old one
  kUnconstrained,  ///< the clouds can slide along each other
  kBeyondDrift,    ///< more than the odometry can have drifted: another, similar place
};
const char* to_string(LoopVerdict verdict);

inline constexpr double kLoopTranslationSigma = 0.01;  // m, of a loop
inline constexpr double kLoopRotationSigma = 1e-3;     // rad
inline constexpr double kLoopGate = 3.0;               // sigmas, of all decisions about loops

/// A loop candidate that was verified, accepted or not.
struct LoopRecord {
  std::size_t first = 0;   ///< keyframe of the first visit
  std::size_t second = 0;  ///< keyframe of the second visit
  bool by_appearance = false;
  LoopVerdict verdict = LoopVerdict::kTooFewPoints;
  Pose first_from_second = Pose::Identity();  ///< measured by ICP
  double fitness = 0.0;                       ///< m^2
  double overlap = 0.0;
  double constraint = 0.0;
  double translation_m = 0.0;  ///< m, translation by which the loop would correct the poses
  double rotation_rad = 0.0;   ///< rad, likewise, rotation
  double path_length = 0.0;    ///< m, path length between the two

  /// False: it agrees with the path to within its own accuracy, so it ties the two visits, and
  /// there is nothing that it could correct.
  bool corrects() const {
    return translation_m > kLoopGate * kLoopTranslationSigma ||
           rotation_rad > kLoopGate * kLoopRotationSigma;
  }
};

/// The points of a keyframe, in its own frame (m).
using KeyframeCloud = std::function<std::span<const Eigen::Vector3f>(std::size_t keyframe)>;

/// Detects loops in a path of keyframes and corrects the path: candidates by distance (LIO-SAM,
/// section III-C.4) and by appearance, verification by ICP and by the possible drift of the
/// odometry, then a pose graph. Independent of how the path was estimated. Searches are triggered
/// by the number of keyframes, so the same input gives bit-identical results; the candidates of a
/// search are verified one per keyframe.
class LoopCloser {
 public:
  LoopCloser(const LoopConfig& config, Parallel parallel)
      : config_(config), parallel_(std::move(parallel)) {}

  /// Adds a keyframe with its pose relative to the one before (the first: to the world); `cloud`
  /// gives the points of all keyframes so far. Returns whether earlier poses() have changed.
  bool add(Time stamp, const Pose& previous_from_this, const KeyframeCloud& cloud);

  /// From now on, no loop is searched for to this keyframe, and its points are not needed any more:
  /// another stands for its place. It must not be one of the kSourceReach last ones.
  void retire(std::size_t keyframe) {
    retired_.insert(keyframe);
    descriptors_.erase(keyframe);
  }
  static constexpr std::size_t kSourceReach = 12;
  /// Keyframe of the second visit of the last loop that was accepted; 0 without any.
  std::size_t closed_until() const { return accepted_.empty() ? 0 : accepted_.back().second; }

  /// world_from_keyframe.
  const std::vector<Pose>& poses() const { return graph_.nodes; }
  const std::vector<LoopRecord>& records() const { return records_; }
  std::size_t accepted() const { return accepted_.size(); }
  std::uint64_t memory_bytes() const;

 private:
  struct Candidate {
    std::size_t keyframe = 0;
    std::size_t seen_from = 0;  ///< keyframe of the second visit
    double path_length = 0.0;   ///< m, path length between the two
    bool by_appearance = false;
    Pose guess = Pose::Identity();  ///< initial guess of keyframe_from_seen_from
  };
  std::size_t last() const { return graph_.nodes.size() - 1; }
  /// Verifies the next candidate: one per keyframe, to limit the time that a keyframe takes.
  bool try_next(const KeyframeCloud& cloud);
  std::vector<Candidate> candidates(const std::vector<double>& path_lengths) const;
  void add_nearest(const std::vector<double>& path_lengths, std::vector<Candidate>& found) const;
  void add_similar(const std::vector<double>& path_lengths, std::vector<Candidate>& found) const;
  bool may_close(std::size_t keyframe, const std::vector<double>& path_lengths) const;
  std::vector<Eigen::Vector3f> around(std::size_t keyframe, std::size_t before, std::size_t after,
                                      const KeyframeCloud& cloud) const;
  LoopRecord verify(const Candidate& candidate, const KeyframeCloud& cloud) const;
  /// Whether the two places are farther apart than drift can explain.
  bool is_beyond_drift(const LoopRecord& loop) const;
  LoopVerdict judge(const IcpResult& icp, const LoopRecord& loop) const;
  /// Path length (m) from each keyframe to the last one, by the shortest path through known loops.
  std::vector<double> path_lengths_to_last() const;
  /// Root of the sum of the squared steps (m) between two keyframes, by which drift accumulates.
  double drift_steps(std::size_t a, std::size_t b) const;
  /// Whether the two differ by no more than their errors and the drift between them.
  bool agree(const LoopRecord& a, const LoopRecord& b) const;
  /// The last record and the waiting ones that agree with it, if they are enough to be accepted;
  /// else none, and the last record waits, too.
  std::vector<LoopRecord> confirmed_loops();
  void close(const std::vector<LoopRecord>& loops);

  LoopConfig config_;
  Parallel parallel_;
  std::vector<Time> stamps_;
  std::vector<double> steps_;                           ///< m, path length from the keyframe before
  std::map<std::size_t, PlaceDescriptor> descriptors_;  ///< of keyframes that are not retired
  std::set<std::size_t> retired_;
  estimation::PoseGraph graph_;
  std::vector<Candidate> pending_;  ///< of the last search, not verified yet
  std::vector<LoopRecord> records_;
  std::vector<LoopRecord> waiting_;
  std::vector<LoopRecord> accepted_;
  std::multimap<std::size_t, std::size_t> tied_;  ///< keyframes of accepted loops, both ways
};

}  // namespace lidarena::loop
