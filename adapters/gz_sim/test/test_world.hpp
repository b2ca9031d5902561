// SPDX-License-Identifier: BSD-3-Clause
// The world in which the plugins are tested.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "adapters/gz_sim/test/closed_forms.hpp"
#include "adapters/gz_sim/test/test_server.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::gz_sim_test {

namespace fs = std::filesystem;

inline constexpr Time kStep{1'000'000};
inline constexpr double kMaxRange = 15.0;  // m
inline constexpr const char* kGround = "<plane><normal>0 0 1</normal><size>100 100</size></plane>";

/// Elements of a plugin that records without noise; `more` are further elements.
inline std::string recording(const fs::path& file, const std::string& more = "<imu>off</imu>") {
  return fmt::format(
      "<sensor>livox_mid360</sensor><set>max_range_m={}</set><noise>off</noise>"
      "<gazebo>off</gazebo><record>{}</record>{}",
      kMaxRange, file.string(), more);
}

/// The ground, and a ball, a box and a pillar around the origin.
inline std::string primitives() {
  return model("ground", {}, shape(kGround)) +
         model("ball", {{0, 6, 1}}, shape("<sphere><radius>1.5</radius></sphere>")) +
         model("box", {{5, 0, 1}, {0.1, 0.2, 0.3}}, shape("<box><size>1 2 2</size></box>")) +
         model("pillar", {{-7, 0, 1}, {0.3, 0.2, 0}},
               shape("<cylinder><radius>0.5</radius><length>3</length></cylinder>"));
}
inline std::vector<Distance> primitives_in_closed_form() {
  return {plane_at(0.0), ball({0, 6, 1}, 1.5),
          box(SdfPose{{5, 0, 1}, {0.1, 0.2, 0.3}}.pose(), {1, 2, 2}),
          cylinder(SdfPose{{-7, 0, 1}, {0.3, 0.2, 0}}.pose(), 0.5, 3.0)};
}

/// A motion of constant velocity that turns about a tilted axis.
struct Motion {
  static constexpr double kRate = 1.5;  // rad/s
  Vector3d start{0, 0, 1.5}, velocity{3, -1, 0.2};
  Vector3d axis = Vector3d(0.3, 0.2, 1.0).normalized();

  Pose at(double t_s) const {
    return make_pose(Eigen::Quaterniond(Eigen::AngleAxisd(kRate * t_s, axis)),
                     start + t_s * velocity);
  }
  std::string tum(double seconds) const {
    std::string text;
    for (int i = 0; 0.01 * i <= seconds; ++i) {
      const Pose pose = at(0.01 * i);
      const Eigen::Quaterniond q(pose.linear());
      const Vector3d p = pose.translation();
      text += fmt::format("{:.2f} {:.16} {:.16} {:.16} {:.16} {:.16} {:.16} {:.16}\n", 0.01 * i,
                          p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w());
    }
    return text;
  }
};

/// A model with this content and the plugin that moves it.
inline std::string flying(const std::string& content, const fs::path& trajectory) {
  return "<model name=\"robot\"><link name=\"link\">" + content +
         "</link><plugin filename=\"LidarenaGzFlight\" name=\"lidarena::Flight\"><trajectory>" +
         trajectory.string() + "</trajectory></plugin></model>";
}

/// Each test has a folder for its recordings.
class GzSim : public testing::Test {
 protected:
  fs::path file(const std::string& name = "flight.mcap") const { return folder_.path() / name; }
  TemporaryFolder folder_;
};

}  // namespace lidarena::gz_sim_test
