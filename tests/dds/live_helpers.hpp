// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <functional>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "adapters/dds/live_reader.hpp"
#include "adapters/dds/live_writer.hpp"
#include "lidarena/base/config_json.hpp"
#include "lidarena/base/random.hpp"
#include "lidarena/dataset/messages/ros_messages.hpp"
#include "lidarena/dataset/text_file.hpp"
#include "tests/temporary_folder.hpp"

/// Shared by the tests of live topics: messages to send, and the program as another process.
namespace lidarena::dds {

namespace fs = std::filesystem;
using dataset::Bytes;
using Messages = std::map<std::string, std::vector<std::string>>;  // bytes by topic, in order

inline constexpr const char* kPoints = "/lidar/points";
inline constexpr const char* kImu = "/lidar/imu";
inline constexpr std::chrono::seconds kLimit(60);

/// A domain of its own for each test and each process, so that tests may run side by side.
inline LiveOptions live_options() {
  static int tests = 0;
  return {.domain = 1 + (static_cast<int>(getpid()) + 20 * ++tests) % 230};
}

/// Ends a reading to which nothing comes.
inline std::function<bool()> after(std::chrono::seconds limit) {
  return [end = std::chrono::steady_clock::now() + limit] {
    return std::chrono::steady_clock::now() > end;
  };
}

inline std::string text_of(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// A second of a LiDAR with 5,003 points a scan and an IMU of 100 Hz.
struct Sample {
  std::string topic;
  std::string_view type;
  Time time;
  std::string bytes;
};
inline std::vector<Sample> samples() {
  SequentialRandom random(7);
  dataset::MessageWriter message;
  std::vector<Sample> samples;
  const auto add = [&](const char* topic, std::string_view type, Time time) {
    samples.push_back({topic, type, time, text_of(message.bytes())});
  };
  dataset::ros::encode_transforms({}, message);
  add("/tf_static", dataset::ros::kTfMessage, Time{1'000'000'000});
  for (int i = 1; i <= 100; ++i) {
    const Time time{1'000'000'000 + 10'000'000 * i};
    dataset::ros::encode_imu({time, Eigen::Vector3d(0.1 * i, 0, 0), Eigen::Vector3d(0, 0, 9.81)},
                             "imu", message);
    add(kImu, dataset::ros::kImu, time);
    if (i % 10 != 0) continue;
    Scan scan{time, std::vector<Point>(5003)};
    for (Point& point : scan.points) point.position.x() = static_cast<float>(random.uniform());
    dataset::ros::encode_scan(scan, "lidar", message);
    add(kPoints, dataset::ros::kPointCloud2, time);
  }
  return samples;
}

inline Messages by_topic(const std::vector<Sample>& samples) {
  Messages messages;
  for (const Sample& sample : samples) messages[sample.topic].push_back(sample.bytes);
  return messages;
}

inline Messages read_all(dataset::RecordingReader& reader) {
  Messages messages;
  while (const auto message = reader.next())
    messages[std::string(message->topic)].push_back(text_of(message->data));
  return messages;
}

/// Writes the samples; topics of a live writer are announced first.
inline void write_all(dataset::RecordingWriter& out, const std::vector<Sample>& samples,
                      std::chrono::milliseconds wait = {}, double rate = 0.0) {
  std::map<std::string, std::uint16_t> topics;
  for (const Sample& sample : samples) {
    if (!topics.contains(sample.topic))
      topics[sample.topic] = out.add_topic(sample.topic, sample.type, sample.topic == "/tf_static");
  }
  std::this_thread::sleep_for(wait);
  Time last = samples.front().time;
  for (const Sample& sample : samples) {
    if (rate > 0.0)
      std::this_thread::sleep_for(
          std::chrono::duration<double>(to_seconds(sample.time - last) / rate));
    last = sample.time;
    out.write(topics.at(sample.topic), sample.time, sample.time,
              std::as_bytes(std::span(sample.bytes)));
  }
  out.close();
}

/// The program lidarena as another process, with output into a file.
class Program {
 public:
  Program(const std::string& arguments, const fs::path& output) {
    const std::string line =
        std::string("exec " LIDARENA_BINARY " ") + arguments + " > " + output.string() + " 2>&1";
    process_ = fork();
    if (process_ == 0) {
      execl("/bin/sh", "sh", "-c", line.c_str(), nullptr);
      _exit(127);
    }
  }
  ~Program() {
    if (process_ <= 0) return;
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
  }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  /// Its exit code; -1: a signal ended it.
  int wait() {
    int status = 0;
    waitpid(process_, &status, 0);
    process_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  void send(int signal) const { kill(process_, signal); }

 private:
  pid_t process_;
};

/// Calls of the program in a folder, in a domain of its own.
class LiveCalls {
 public:
  const LiveOptions& options() const { return options_; }
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  std::string text(const std::string& name) const { return dataset::read_bytes(path(name)); }
  Json json(const std::string& name) const { return Json::parse(text(name)); }
  /// Runs it to its end; what it prints is in `log`.
  int call(const std::string& arguments, const std::string& log = "log.txt") const {
    return Program(arguments, path(log)).wait();
  }
  /// Starts it; `arguments` of a verb with live topics.
  Program start(const std::string& arguments, const std::string& log) const {
    return Program(arguments + domain(), path(log));
  }
  std::string domain() const { return " --domain " + std::to_string(options_.domain); }
  /// Simulates the house with a Mid-360.
  void simulate(const std::string& out, double seconds, const std::string& more = {}) const {
    ASSERT_EQ(call("simulate --world house --flight house --sensor livox_mid360 --seconds " +
                   std::to_string(seconds) + " --out " + path(out) + more),
              0)
        << text("log.txt");
  }

 private:
  TemporaryFolder folder_;
  LiveOptions options_ = live_options();
};

/// Waits until a topic has so many subscribers.
inline void wait_for_subscribers(const LiveWriter& writer, std::uint16_t topic,
                                 std::size_t count = 1) {
  const auto end = std::chrono::steady_clock::now() + kLimit;
  while (writer.subscribers(topic) < count && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  ASSERT_GE(writer.subscribers(topic), count);
}

}  // namespace lidarena::dds
