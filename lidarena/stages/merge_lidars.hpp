// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "lidarena/base/event.hpp"
#include "lidarena/base/rig.hpp"

namespace lidarena::stages {

/// The events of another source, with the points of further LiDARs in the scans of one. Each of
/// their points is added to the first scan that ends no earlier, in that LiDAR's frame, in the
/// order of time; Scan::origins has the places of all LiDARs. A scan waits until the others have
/// measured as long as it, or, for LiDARs that have become silent, until two more scans have come.
class MergeLidars final : public EventSource {
 public:
  MergeLidars(std::unique_ptr<EventSource> source, const LidarInfo& lidar,
              const std::vector<LidarInfo>& others);

  /// Throws InputError at a scan whose points have no times.
  std::optional<Event> next() override;

 private:
  struct Waiting {
    Time stamp;
    Point point;
  };
  struct Other {
    std::string id;
    Pose lidar_from_other;
    Time measured_until{Time::min()};
    std::vector<Waiting> points{};
  };

  void take(Event event);
  bool is_scan(const Event& event) const;
  bool is_complete(const Scan& scan) const;
  void add_points(Scan& scan);

  std::unique_ptr<EventSource> source_;
  std::string lidar_id_;
  Time period_;
  std::vector<Eigen::Vector3f> origins_;
  std::vector<Other> others_;
  std::deque<Event> held_;
  std::size_t held_scans_ = 0;
  bool ended_ = false;
};

}  // namespace lidarena::stages
