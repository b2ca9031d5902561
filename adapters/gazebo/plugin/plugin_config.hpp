// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>
#include <utility>

#include "lidarena/base/config.hpp"
#include "lidarena/dataset/dataset.hpp"
#include "lidarena/sensor/sensor_config.hpp"

namespace lidarena::gazebo_plugin {

/// Kind of shapes that the rays hit.
enum class Geometry { kCollision, kVisual };

constexpr auto enum_names(Geometry) {
  return std::array{std::pair{"collision", Geometry::kCollision},
                    std::pair{"visual", Geometry::kVisual}};
}

/// The elements inside <plugin>; fields have their names. The defaults of `ros` and `gazebo` are
/// those of Gazebo Classic.
struct PluginConfig {
  std::string sensor = "livox_mid360";
  std::string set;
  std::string id;
  std::uint64_t seed = 1;
  bool noise = true;
  bool imu = true;
  Geometry geometry = Geometry::kVisual;
  int threads = 0;
  std::string record;
  double record_seconds = 0.0;
  bool stop = false;
  dataset::Dialect dialect = dataset::Dialect::kSi;
  bool ros = true;
  bool gazebo = false;
  std::string topic;
  std::string imu_topic;
  std::string frame;
  std::string csv_file_name;
  int samples = 0;
  int downsample = 1;
  std::string ros_topic;
  int publish_pointcloud_type = -1;
  bool visualize = false;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("sensor", self.sensor, "", "name of a file in configs/sensors, or a path");
    v("set", self.set, "", "key=value pairs that override the sensor file, separated by spaces");
    v("id", self.id, "",
      "name in topics and recordings, key of the noise; that of `sensor` if empty");
    v("seed", self.seed, "", "seed of the noise");
    v("noise", self.noise, "", "off: exact ranges, error-free IMU");
    v("imu", self.imu, "", "simulate the IMU inside the sensor, if it has one");
    v("geometry", self.geometry, "", "shapes that the rays hit");
    v("threads", self.threads, "", "0: cast within the world's update; 1: on a separate thread",
      between(0, 1));
    v("record", self.record, "", "dataset folder, or .bag or .mcap file, to write");
    v("record_seconds", self.record_seconds, "s", "simulated time to record, 0 = until the end",
      at_least(0));
    v("stop", self.stop, "", "exit the simulator after record_seconds");
    v("dialect", self.dialect, "",
      "si, or driver: units and message layouts of the sensor's ROS driver");
    v("ros", self.ros, "",
      "publish on the topics of ROS nodes, if the plugin was built with it: ROS 1 (Gazebo "
      "Classic), "
      "ROS 2 (gz-sim)");
    v("gazebo", self.gazebo, "", "publish through Gazebo's own transport");
    v("topic", self.topic, "", "topic of the points; /ID/points if empty");
    v("imu_topic", self.imu_topic, "", "topic of the IMU; /ID/imu if empty");
    v("frame", self.frame, "", "frame_id of the points; ID_lidar if empty");
    // Elements of the Livox plugins for Gazebo, so that their models need only another file name.
    v("csv_file_name", self.csv_file_name, "",
      "Livox's table of rays; not needed for sensors with a built-in pattern");
    v("samples", self.samples, "", "rays per scan, with csv_file_name", at_least(0));
    v("downsample", self.downsample, "", "must be 1: every row is fired", between(1, 1));
    v("ros_topic", self.ros_topic, "", "the same as topic");
    v("publish_pointcloud_type", self.publish_pointcloud_type, "",
      "0 to 2: a PointCloud2; 3: Livox's CustomMsg", between(-1, 3));
    v("visualize", self.visualize, "", "ignored");
  }
};

/// Values of the surrounding <sensor> and its <ray>; 0 if not given.
struct SensorElement {
  double update_rate = 0.0;
  double min_range = 0.0, max_range = 0.0;
  Pose body_from_sensor = Pose::Identity();
};

/// Configuration of the sensor to simulate. Throws InputError (place: the plugin's name) if the
/// configuration names a sensor or file that does not exist.
sensor::SensorConfig sensor_of(const PluginConfig& config, const SensorElement& element,
                               const std::string& place);

}  // namespace lidarena::gazebo_plugin
