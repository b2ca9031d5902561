// SPDX-License-Identifier: BSD-3-Clause
#include "adapters/gazebo/plugin/output.hpp"
#include "lidarena/dataset/dataset.hpp"

namespace lidarena::gazebo_plugin {
namespace {

class Recorder final : public Output {
 public:
  Recorder(const PluginConfig& config, const Rig& rig, std::string source)
      : writer_(config.record, rig, {dataset::DatasetFormat::kMcap, config.dialect, false}),
        source_(std::move(source)) {}
  void write(const Event& event) override { writer_.write(event); }
  void write_truth(const StampedPose& pose) override { writer_.write_truth(pose); }
  void finish() override { writer_.finish({{"kind", "dataset"}, {"source", source_}}); }

 private:
  dataset::DatasetWriter writer_;
  std::string source_;
};

}  // namespace

std::unique_ptr<Output> make_recorder(const PluginConfig& config, const Rig& rig,
                                      const std::string& source) {
  return std::make_unique<Recorder>(config, rig, source);
}

std::string points_topic(const PluginConfig& config, const Rig& rig) {
  if (!config.topic.empty()) return config.topic;
  return config.ros_topic.empty() ? "/" + rig.lidars.front().id + "/points" : config.ros_topic;
}

std::string imu_topic(const PluginConfig& config, const Rig& rig) {
  return config.imu_topic.empty() ? "/" + rig.lidars.front().id + "/imu" : config.imu_topic;
}

std::string points_frame(const PluginConfig& config, const Rig& rig) {
  return config.frame.empty() ? rig.lidars.front().id + "_lidar" : config.frame;
}

}  // namespace lidarena::gazebo_plugin
