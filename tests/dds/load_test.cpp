// SPDX-License-Identifier: BSD-3-Clause
// Subscribers that are slow or stalled, and messages that are none.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "lidarena/dataset/json_file.hpp"
#include "tests/dds/live_helpers.hpp"

namespace lidarena::dds {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;
using ::testing::AllOf;
using ::testing::HasSubstr;

/// Resident memory of this process, MB.
double resident_mb() {
  std::ifstream file("/proc/self/statm");
  std::size_t all = 0, resident = 0;
  file >> all >> resident;
  return 1e-6 * static_cast<double>(resident) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

TEST(Load, WhatASlowSubscriberMissesIsCounted) {
  const LiveCalls live;
  write_all(*dataset::create_recording(live.path("a.mcap"), {}), samples());
  LiveReader reader(live.options(), {.topics = {kImu},
                                     .idle = std::chrono::seconds(3),
                                     .stopped = after(kLimit),
                                     .waiting = {{kImu, 5}}});
  Program play = live.start("play --wait 3 " + live.path("a.mcap"), "play.txt");
  std::vector<std::string> received;
  while (const auto message = reader.next()) {
    received.push_back(text_of(message->data));
    std::this_thread::sleep_for(milliseconds(50));  // a sample comes each 10 ms
  }
  EXPECT_EQ(play.wait(), 0);
  const std::vector<std::string> sent = by_topic(samples()).at(kImu);
  EXPECT_EQ(received.size() + reader.lost(), sent.size());
  EXPECT_EQ(reader.lost(kImu), reader.lost());
  EXPECT_GT(reader.lost(), 50U);
  EXPECT_EQ(received.back(), sent.back());
}

TEST(Load, ASubscriberThatIsFastEnoughMissesNothing) {
  const LiveCalls live;
  write_all(*dataset::create_recording(live.path("a.mcap"), {}), samples());
  LiveReader reader(live.options(), {.topics = {kImu},
                                     .idle = std::chrono::seconds(3),
                                     .stopped = after(kLimit),
                                     .waiting = {{kImu, 50}}});
  Program play = live.start("play --wait 3 " + live.path("a.mcap"), "play.txt");
  std::size_t received = 0;
  while (reader.next()) ++received;
  EXPECT_EQ(play.wait(), 0);
  EXPECT_EQ(received, 100U);
  EXPECT_EQ(reader.lost(), 0U);
}

/// Clouds of 1 MB, 20 times a second; the longest time that sending one took.
class BigClouds {
 public:
  explicit BigClouds(const LiveOptions& options)
      : out_(options), topic_(out_.add_topic(kPoints, dataset::ros::kPointCloud2, false)) {}
  void wait_for(std::size_t subscribers) const { wait_for_subscribers(out_, topic_, subscribers); }
  void send(int count) {
    for (int i = 0; i < count; ++i) {
      const auto begin = steady_clock::now();
      dataset::ros::encode_scan(cloud_, "lidar", message_);
      out_.write(topic_, Time{1}, Time{1}, message_.bytes());
      longest_ = std::max(longest_, steady_clock::now() - begin);
      std::this_thread::sleep_until(begin + milliseconds(50));
    }
  }
  double longest_s() const { return std::chrono::duration<double>(longest_).count(); }
  void close() { out_.close(); }

 private:
  LiveWriter out_;
  std::uint16_t topic_;
  Scan cloud_{Time{1}, std::vector<Point>(41'667)};
  dataset::MessageWriter message_;
  steady_clock::duration longest_{0};
};

TEST(Load, AStalledSubscriberDelaysNobodyAndFillsNoMemory) {
  const LiveCalls live;
  BigClouds clouds(live.options());
  const std::string record = "record --json --idle 9 --topic /lidar/points --out ";
  Program well = live.start(record + live.path("well.mcap"), "well.json");
  Program stalled = live.start(record + live.path("stalled.mcap"), "stalled.json");
  clouds.wait_for(2);
  clouds.send(10);
  stalled.send(SIGSTOP);
  const double before_mb = resident_mb();
  clouds.send(100);
  const double grown_mb = resident_mb() - before_mb;
  stalled.send(SIGCONT);
  clouds.send(10);
  clouds.close();
  RecordProperty("grown_kb", static_cast<int>(1e3 * grown_mb));
  RecordProperty("longest_us", static_cast<int>(1e6 * clouds.longest_s()));
  EXPECT_LT(grown_mb, 40.0) << "of 100 MB";
  EXPECT_LT(clouds.longest_s(), 0.2);
  ASSERT_EQ(well.wait(), 0) << live.text("well.json");
  ASSERT_EQ(stalled.wait(), 0) << live.text("stalled.json");
  const Json of_well = live.json("well.json"), of_stalled = live.json("stalled.json");
  EXPECT_EQ(of_well.at("messages"), 120);
  EXPECT_EQ(of_well.at("lost"), 0);
  const auto received = of_stalled.at("messages").get<int>();
  RecordProperty("received_by_the_stalled", received);
  EXPECT_EQ(received + of_stalled.at("lost").get<int>(), 120);
  EXPECT_GT(of_stalled.at("lost"), 20);
  EXPECT_GE(received, 20);
  EXPECT_EQ(of_stalled.at("topics").at(kPoints).at("lost"), of_stalled.at("lost"));
}

TEST(Load, APublisherEndsBesideAStalledSubscriber) {
  const LiveCalls live;
  live.simulate("data", 2.0);
  Program stalled =
      live.start("record --topic /livox_mid360/points --out " + live.path("a.mcap"), "stalled.txt");
  Program play = live.start("play --json --wait 4 " + live.path("data"), "play.json");
  std::this_thread::sleep_for(std::chrono::seconds(5));
  stalled.send(SIGSTOP);
  const auto begin = steady_clock::now();
  EXPECT_EQ(play.wait(), 0);
  EXPECT_LT(std::chrono::duration<double>(steady_clock::now() - begin).count(), 15.0);
  const Json told = live.json("play.json");
  EXPECT_EQ(told.at("topics").at("/livox_mid360/points").at("subscribers"), 1);
  EXPECT_EQ(told.at("topics").at("/livox_mid360/points").at("messages"), 20);
  stalled.send(SIGCONT);
}

/// Sweeps of a sphere, which any odometry takes for standing still.
class Sphere {
 public:
  explicit Sphere(const LiveOptions& options)
      : out_(options),
        topic_(out_.add_topic("/livox_mid360/points", dataset::ros::kPointCloud2, false)) {}
  void wait() const { wait_for_subscribers(out_, topic_); }
  std::string sweep(double seconds) {
    Scan scan{from_seconds(seconds), {}};
    for (int i = 0; i < 2000; ++i) {
      const double z = 1.0 - 2.0 * (i + 0.5) / 2000.0, turn = 2.4 * i, r = std::sqrt(1.0 - z * z);
      Point point;
      point.position = Eigen::Vector3d(r * std::cos(turn), r * std::sin(turn), z).cast<float>() * 4;
      point.dt_ns = i * 40'000;
      scan.points.push_back(point);
    }
    dataset::ros::encode_scan(scan, "lidar", message_);
    return text_of(message_.bytes());
  }
  void send(const std::string& bytes) {
    out_.write(topic_, Time{1}, Time{1}, std::as_bytes(std::span(bytes)));
    std::this_thread::sleep_for(milliseconds(50));
  }
  void close() { out_.close(); }

 private:
  LiveWriter out_;
  std::uint16_t topic_;
  dataset::MessageWriter message_;
};

/// A cloud whose only field lies beyond its points.
std::string cloud_with_wrong_layout() {
  dataset::MessageWriter message;
  dataset::ros::put_header(from_seconds(0.45), "lidar", message);
  for (const std::uint32_t size : {1U, 1U, 1U}) message.put(size);  // height, width, fields
  message.put(std::string_view("x"));
  message.put(std::uint32_t{100});  // offset
  message.put(std::uint8_t{7});     // float32
  message.put(std::uint32_t{1});
  message.put(std::uint8_t{0});  // little endian
  message.put(std::uint32_t{12});
  message.put(std::uint32_t{12});
  message.put_octets(12);
  message.put(std::uint8_t{1});
  return text_of(message.bytes());
}

TEST(Load, BadMessagesAreLeftOutCountedAndSaid) {
  const LiveCalls live;
  Sphere sphere(live.options());
  Program run = live.start(
      "run kiss_icp --live --idle 3 --sensor livox_mid360 --out " + live.path("run"), "run.txt");
  sphere.wait();
  for (const double t : {0.1, 0.2, 0.3, 0.4}) sphere.send(sphere.sweep(t));
  sphere.send(sphere.sweep(0.45).substr(0, 20'000));
  sphere.send(cloud_with_wrong_layout());
  sphere.send(sphere.sweep(0.2));  // back in time
  for (const double t : {0.5, 0.6}) sphere.send(sphere.sweep(t));
  sphere.close();
  ASSERT_EQ(run.wait(), 0) << live.text("run.txt");
  const Json manifest = dataset::read_json(live.path("run/manifest.json"));
  EXPECT_EQ(manifest.at("summary").at("scans"), 6);
  EXPECT_EQ(manifest.at("messages").at("bad").at("/livox_mid360/points"), 2);
  EXPECT_EQ(manifest.at("messages").at("out_of_order").at("/livox_mid360/points"), 1);
  EXPECT_FALSE(manifest.at("messages").contains("lost"));
  EXPECT_THAT(live.text("run.txt"),
              AllOf(HasSubstr("shorter than its type requires"), HasSubstr("are left out"),
                    HasSubstr("a stamp of 0.200000000 s after one of 0.400000000 s")));
}

TEST(Load, ScansThatABusyAlgorithmMissesAreCounted) {
  const LiveCalls live;
  Sphere sphere(live.options());
  Program run = live.start(
      "run kiss_icp --live --queue 1 --idle 3 --sensor livox_mid360 --out " + live.path("run"),
      "run.txt");
  sphere.wait();
  sphere.send(sphere.sweep(0.1));
  run.send(SIGSTOP);  // as busy as can be
  for (int i = 2; i <= 20; ++i) sphere.send(sphere.sweep(0.1 * i));
  run.send(SIGCONT);
  for (int i = 21; i <= 25; ++i) sphere.send(sphere.sweep(0.1 * i));
  sphere.close();
  ASSERT_EQ(run.wait(), 0) << live.text("run.txt");
  const Json manifest = dataset::read_json(live.path("run/manifest.json"));
  const auto scans = manifest.at("summary").at("scans").get<int>();
  const auto lost = manifest.at("messages").at("lost").at("/livox_mid360/points").get<int>();
  EXPECT_EQ(scans + lost, 25);
  EXPECT_GT(lost, 5);
  EXPECT_THAT(live.text("run.txt"), HasSubstr("messages were lost or dropped"));
}

}  // namespace
}  // namespace lidarena::dds
