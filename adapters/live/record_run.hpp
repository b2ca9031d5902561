// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "adapters/dds/participant.hpp"
#include "adapters/live/pose_record.hpp"
#include "lidarena/base/parallel.hpp"
#include "lidarena/stages/external_program.hpp"

namespace lidarena::live {

/// Options of `record --truth`.
struct RunToRecord {
  std::string dataset;  ///< that is played, and scored against; empty: not asked for
  std::string name = "node";
  std::string sensor;   ///< of the dataset; may be empty if there is only one
  std::string pose_of;  ///< body, lidar or imu; empty: by the frame that the poses name
  ResultTopics topics;
  double first_limit_s = 60.0;
};

/// What poses of the frame `frame` are of, by the names of frames in a dataset: body, ID_lidar,
/// ID_imu, whatever stands before a slash. Others are taken for the LiDAR's, which is logged.
stages::PoseOf pose_of_frame(const std::string& frame, const Rig& rig, LogSink& log);

/// Collects a SLAM node's results until nothing comes for `idle_s` or Ctrl-C, and writes the RUN
/// folder `out`. Returns the number of poses. Throws Error if no pose came.
std::size_t record_run(const RunToRecord& run, const dds::LiveOptions& live, double idle_s,
                       const std::string& out, const Parallel& parallel, LogSink& log);

}  // namespace lidarena::live
