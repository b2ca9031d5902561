// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "lidarena/base/parallel.hpp"
#include "lidarena/estimation/pose_graph.hpp"
#include "lidarena/map/feature_map.hpp"
#include "lidarena/odometry/lio_sam/config.hpp"

namespace lidarena::odometry::lio_sam {

/// The keyframe nearest to the last one, within the search radius and older by the time gap.
std::optional<std::size_t> find_candidate(const std::vector<map::Keyframe>& keyframes,
                                          const LoopRule& rule);

/// Loop closure of the program (section III-C.4) and the graph of keyframes that it corrects.
class LoopSearch {
 public:
  LoopSearch(const Config& config, Parallel parallel)
      : config_(config), parallel_(std::move(parallel)) {}

  /// Searches from the last keyframe, which must be new, if a search is due. Returns whether a loop
  /// moved poses; world_from_keyframe are then in poses().
  bool close(const std::vector<map::Keyframe>& keyframes, const Pose& previous_from_last);
  const std::vector<Pose>& poses() const { return graph_.nodes; }

  std::size_t tried() const { return tried_; }
  std::size_t accepted() const { return accepted_; }
  std::uint64_t memory_bytes() const { return estimation::memory_bytes(graph_); }

 private:
  /// The loop from the last keyframe to `candidate`, if it is accepted.
  std::optional<estimation::PoseGraph::Between> verify(const std::vector<map::Keyframe>& keyframes,
                                                       std::size_t candidate) const;

  Config config_;
  Parallel parallel_;
  estimation::PoseGraph graph_;
  std::optional<Time> last_search_;
  std::size_t tried_ = 0;
  std::size_t accepted_ = 0;
};

}  // namespace lidarena::odometry::lio_sam
