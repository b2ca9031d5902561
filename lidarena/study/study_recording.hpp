// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "lidarena/base/config_json.hpp"
#include "lidarena/base/pose.hpp"
#include "lidarena/stages/config_folder.hpp"

namespace lidarena::study {

/// A recording of a real place, with the trajectory that it is scored against.
struct StudyRecording {
  std::string name, like, file, truth, truth_topic;
  std::optional<Pose> truth_from_body;
  std::string sensor, imu_topic;
  std::optional<Pose> body_from_lidar;
  std::string layout;
  double rate_hz = 10.0;
  std::string source, about;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("name", self.name, "", "its name in the results");
    v("like", self.like, "",
      "name in configs/recordings, or a file: its values hold where this has none");
    v("file", self.file, "", "the recording, as `lidarena run` takes it");
    v("truth", self.truth, "", "its trajectory, as `lidarena evaluate --truth` takes it");
    v("truth_topic", self.truth_topic, "", "topic of the poses, if the truth is in a bag");
    v("truth_from_body", self.truth_from_body, "m, quaternion",
      "lever arm: pose of the body (see body_from_lidar) in the frame whose poses the truth has");
    v("sensor", self.sensor, "", "topic or id of the LiDAR, if there are several");
    v("imu_topic", self.imu_topic, "", "topic of the IMU, if there are several");
    v("body_from_lidar", self.body_from_lidar, "m, quaternion",
      "mounting of the LiDAR; absent: as the recording states it");
    v("layout", self.layout, "", "fields of a point in raw binary sweeps");
    v("rate_hz", self.rate_hz, "Hz", "sweeps per second, for a folder without times", above(0));
    v("source", self.source, "", "where to get it");
    v("about", self.about, "", "frames, format of the truth, what was tried");
  }
};

/// The recording with the values of `like` where it has none, and absolute paths. Throws InputError
/// if it has no name, file or truth, if one of them does not exist, or if there is no such `like`.
StudyRecording resolved(const StudyRecording& recording, const stages::ConfigFolder& configs);

/// Bytes of the recording: of the file, or of all files of a folder.
std::uint64_t bytes_of(const StudyRecording& recording);

}  // namespace lidarena::study
