// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "lidarena/base/imu_sample.hpp"
#include "lidarena/base/pose.hpp"
#include "lidarena/base/scan.hpp"

namespace lidarena::gz_sim_test {

/// A server without a display, in this process: gravity, steps of 1 ms, physics and user commands.
class TestServer {
 public:
  /// `models`: what the world contains, as SDF.
  explicit TestServer(const std::string& models);
  ~TestServer();

  void step(unsigned int count);
  /// The commands of a user; they take effect in the next step.
  void spawn(const std::string& model);
  void remove(const std::string& name);
  void place(const std::string& name, const Eigen::Vector3d& position);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A <pose> of position (m) and roll, pitch, yaw (rad), and what it means.
struct SdfPose {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Vector3d angles = Eigen::Vector3d::Zero();

  std::string sdf() const;
  Pose pose() const;
};

/// A <model> of one link with this content. Without `moves` it is static.
std::string model(const std::string& name, const SdfPose& pose, const std::string& content,
                  bool moves = false);
/// A <visual> (or, by `kind`, <collision>) of this geometry.
std::string shape(const std::string& geometry, const std::string& kind = "visual");
/// A <sensor> with the plugin and these elements in it.
std::string sensor(const SdfPose& pose, const std::string& elements);

std::vector<Scan> scans_in(const std::filesystem::path& recording, const std::string& id);
std::vector<ImuSample> samples_in(const std::filesystem::path& recording, const std::string& id);

}  // namespace lidarena::gz_sim_test
