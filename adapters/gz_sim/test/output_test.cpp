// SPDX-License-Identifier: BSD-3-Clause
// The plugins in a running server: what they publish and record, and what they refuse.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <mutex>
#include <thread>

#include "adapters/gazebo/plugin/transport.hpp"
#include "adapters/gz_sim/test/test_server.hpp"
#include "adapters/gz_sim/test/test_world.hpp"

namespace lidarena::gz_sim_test {
namespace {

TEST_F(GzSim, AThreadOfItsOwnGivesTheSameScans) {
  const Motion motion;
  const fs::path trajectory = folder_.write("motion.tum", motion.tum(0.8));
  for (const char* threads : {"0", "1"}) {
    TestServer server(primitives() +
                      flying(sensor({}, recording(file(std::string(threads) + ".mcap"),
                                                  fmt::format("<threads>{}</threads>", threads))),
                             trajectory));
    server.step(500);
  }
  const auto own = scans_in(file("0.mcap"), "livox_mid360");
  const auto other = scans_in(file("1.mcap"), "livox_mid360");
  ASSERT_EQ(own.size(), 3U);  // the fourth waits for an IMU sample
  ASSERT_EQ(other.size(), own.size());
  for (std::size_t i = 0; i < own.size(); ++i) {
    ASSERT_EQ(own[i].points.size(), other[i].points.size());
    for (std::size_t k = 0; k < own[i].points.size(); ++k) {
      ASSERT_EQ(own[i].points[k].position, other[i].points[k].position);
      ASSERT_EQ(own[i].points[k].dt_ns, other[i].points[k].dt_ns);
    }
  }
}

/// The clouds of a topic as they arrive.
class Subscriber {
 public:
  using Cloud = gazebo_plugin::gz_msgs::PointCloudPacked;

  explicit Subscriber(const std::string& topic) {
    std::function<void(const Cloud&)> keep = [this](const Cloud& cloud) {
      const std::lock_guard lock(mutex_);
      clouds_.push_back(cloud);
    };
    node_.Subscribe(topic, keep);
  }
  /// Waits until `count` clouds are there, at most 5 s.
  std::vector<Cloud> wait_for(std::size_t count) {
    for (int i = 0; i < 500; ++i) {
      {
        const std::lock_guard lock(mutex_);
        if (clouds_.size() >= count) return clouds_;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    const std::lock_guard lock(mutex_);
    return clouds_;
  }

 private:
  gazebo_plugin::gz_transport::Node node_;
  std::mutex mutex_;
  std::vector<Cloud> clouds_;
};

template <class T>
T value_at(const std::string& data, std::size_t offset) {
  T value{};
  std::memcpy(&value, data.data() + offset, sizeof(T));
  return value;
}

TEST_F(GzSim, ThePublishedCloudsAreTheRecordedOnes) {
  Subscriber subscriber("/front/points");
  {
    TestServer server(primitives() + model("robot", {{0, 0, 1}},
                                           sensor({}, "<id>front</id><imu>off</imu><record>" +
                                                          file().string() + "</record>")));
    server.step(350);
    ASSERT_EQ(subscriber.wait_for(2).size(), 2U);
  }
  const std::vector<Scan> scans = scans_in(file(), "front");
  const auto clouds = subscriber.wait_for(2);
  ASSERT_EQ(scans.size(), 2U);
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const auto& stamp = clouds[i].header().stamp();
    EXPECT_EQ(Time{stamp.sec() * 1'000'000'000L + stamp.nsec()}, scans[i].stamp);
    EXPECT_EQ(clouds[i].header().data(0).value(0), "front_lidar");
    ASSERT_EQ(clouds[i].width(), scans[i].points.size());
    ASSERT_EQ(clouds[i].field(4).name(), "t");
    for (std::size_t k = 0; k < scans[i].points.size(); ++k) {
      const std::size_t at = k * clouds[i].point_step();
      const Point& point = scans[i].points[k];
      ASSERT_EQ(value_at<float>(clouds[i].data(), at + clouds[i].field(0).offset()),
                point.position.x());
      ASSERT_EQ(value_at<std::uint32_t>(clouds[i].data(), at + clouds[i].field(4).offset()),
                static_cast<std::uint32_t>(point.dt_ns));
    }
    EXPECT_GT(scans[i].points.back().dt_ns, 60'000'000);  // spread over the scan's 0.1 s
  }
}

TEST_F(GzSim, ARecordingEndsWithTheModelThatCarriesTheSensor) {
  TestServer server(primitives() + model("robot", {{0, 0, 1}}, sensor({}, recording(file()))));
  server.step(350);
  EXPECT_FALSE(fs::exists(file()));
  server.remove("robot");
  server.step(2);
  ASSERT_TRUE(fs::exists(file()));
  EXPECT_EQ(scans_in(file(), "livox_mid360").size(), 2U);
}

TEST_F(GzSim, AMisspelledElementSwitchesTheSensorOffAndSaysWhatWasMeant) {
  testing::internal::CaptureStderr();
  {
    TestServer server(
        model("robot", {{0, 0, 1}}, sensor({}, recording(file(), "<geometri>visual</geometri>"))));
    server.step(10);
  }
  const std::string told = testing::internal::GetCapturedStderr();
  EXPECT_NE(told.find("geometri"), std::string::npos) << told;
  EXPECT_NE(told.find("'geometry'"), std::string::npos) << told;
  EXPECT_NE(told.find("switched off"), std::string::npos) << told;
  EXPECT_FALSE(fs::exists(file()));
}

}  // namespace
}  // namespace lidarena::gz_sim_test
