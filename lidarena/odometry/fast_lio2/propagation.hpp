// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "lidarena/base/imu_sample.hpp"
#include "lidarena/estimation/imu_track.hpp"
#include "lidarena/estimation/iterated_update.hpp"
#include "lidarena/odometry/fast_lio2/config.hpp"

namespace lidarena::odometry::fast_lio2 {

/// The instants between which a scan's estimate moves.
struct ScanSpan {
  Time estimated{0};  ///< of the estimate, at the end of the scan before
  Time begin{0};      ///< of the scan: its stamp
  Time end{0};        ///< of the scan
};

/// Forward propagation (section IV-B): moves `estimate` from `scan.estimated` to `scan.end`, in
/// steps from sample to sample with the mean of both, and from the last sample to the end with the
/// input of the last step. `samples` (m/s^2, rad/s): the last one at or before `scan.estimated`,
/// and those up to `scan.end`; without new ones the velocity stays constant. Returns the motion for
/// propagate_backward(); its first pose, that of the end of the scan before, counts as that of the
/// scan's begin, as in the program.
estimation::ImuTrack propagate_forward(const std::vector<ImuSample>& samples, const ScanSpan& scan,
                                       const Config& config, estimation::StateEstimate& estimate);

}  // namespace lidarena::odometry::fast_lio2
