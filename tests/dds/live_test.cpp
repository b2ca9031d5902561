// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <functional>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "adapters/dds/live_reader.hpp"
#include "adapters/dds/live_writer.hpp"
#include "lidarena/base/error.hpp"
#include "lidarena/base/random.hpp"
#include "lidarena/dataset/messages/ros_messages.hpp"
#include "lidarena/dataset/text_file.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::dds {
namespace {

namespace fs = std::filesystem;
using dataset::Bytes;
using Messages = std::map<std::string, std::vector<std::string>>;  // bytes by topic, in order

constexpr const char* kPoints = "/lidar/points";
constexpr const char* kImu = "/lidar/imu";
constexpr std::chrono::seconds kLimit(60);

/// A domain of its own for each test and each process, so that tests may run side by side.
LiveOptions live_options() {
  static int tests = 0;
  return {.domain = 1 + (static_cast<int>(getpid()) + 20 * ++tests) % 230};
}

/// Ends a reading to which nothing comes.
std::function<bool()> after(std::chrono::seconds limit) {
  return [end = std::chrono::steady_clock::now() + limit] {
    return std::chrono::steady_clock::now() > end;
  };
}

std::string text_of(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// A second of a LiDAR with 5,003 points a scan and an IMU of 100 Hz.
struct Sample {
  std::string topic;
  std::string_view type;
  Time time;
  std::string bytes;
};
std::vector<Sample> samples() {
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

Messages by_topic(const std::vector<Sample>& samples) {
  Messages messages;
  for (const Sample& sample : samples) messages[sample.topic].push_back(sample.bytes);
  return messages;
}

Messages read_all(dataset::RecordingReader& reader) {
  Messages messages;
  while (const auto message = reader.next())
    messages[std::string(message->topic)].push_back(text_of(message->data));
  return messages;
}

/// Writes the samples; topics of a live writer are announced first.
void write_all(dataset::RecordingWriter& out, const std::vector<Sample>& samples,
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
  int wait() {
    int status = 0;
    waitpid(process_, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

 private:
  pid_t process_;
};

TEST(Live, PlayedMessagesReachAnotherProcessAsTheyAreInTheFile) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "a.mcap";
  write_all(*dataset::create_recording(file, {}), samples());
  const LiveOptions options = live_options();
  LiveReader reader(options,
                    {.topics = {}, .idle = std::chrono::seconds(3), .stopped = after(kLimit)});
  Program play("play --wait 3 --domain " + std::to_string(options.domain) + " " + file.string(),
               folder.path() / "play.txt");
  Messages received = read_all(reader);
  EXPECT_EQ(play.wait(), 0);
  EXPECT_GE(received["/clock"].size(), 90U);  // a message each 10 ms
  received.erase("/clock");
  EXPECT_EQ(received, by_topic(samples()));
  EXPECT_EQ(reader.lost(), 0U);
}

TEST(Live, TheProgramRecordsWhatAnotherProcessPublishes) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "b.mcap";
  const LiveOptions options = live_options();
  Program record(
      "record --idle 3 --domain " + std::to_string(options.domain) + " --out " + file.string(),
      folder.path() / "record.txt");
  LiveWriter writer(options);
  write_all(writer, samples(), std::chrono::seconds(4), 1.0);
  EXPECT_EQ(record.wait(), 0);
  EXPECT_EQ(read_all(*dataset::open_recording(file)), by_topic(samples()));
}

TEST(Live, ALiveRunEstimatesWhatARunOnTheFileDoesAndPublishesIt) {
  const TemporaryFolder folder;
  const auto path = [&](const std::string& name) { return (folder.path() / name).string(); };
  const auto run = [&](const std::string& arguments) {
    return Program(arguments, path("log.txt")).wait();
  };
  ASSERT_EQ(run("simulate --world house --flight house --sensor livox_mid360 --seconds 3 --out " +
                path("data")),
            0);
  ASSERT_EQ(run("run arena_lio " + path("data") + " --out " + path("file")), 0);
  const LiveOptions options = live_options();
  const std::string domain = " --domain " + std::to_string(options.domain);
  LiveReader poses(options, {.topics = {"/lidarena/odometry"},
                             .idle = std::chrono::seconds(5),
                             .stopped = after(kLimit)});
  Program live("run arena_lio --live --idle 4 --sensor livox_mid360 --out " + path("live") + domain,
               path("live.txt"));
  Program play("play --wait 4 " + path("data") + domain, path("play.txt"));
  const Messages received = read_all(poses);
  EXPECT_EQ(play.wait(), 0);
  ASSERT_EQ(live.wait(), 0);
  EXPECT_EQ(dataset::read_bytes(path("live/live.tum")), dataset::read_bytes(path("file/live.tum")));
  ASSERT_EQ(received.size(), 1U);
  EXPECT_EQ(received.begin()->second.size(), 30U);
}

TEST(Live, OnlyTheTopicsThatWereAskedForAreRead) {
  const LiveOptions options = live_options();
  LiveReader reader(options,
                    {.topics = {kImu}, .idle = std::chrono::seconds(1), .stopped = after(kLimit)});
  std::thread publisher([&] {
    LiveWriter writer(options);
    write_all(writer, samples(), std::chrono::seconds(2), 2.0);
  });
  const Messages received = read_all(reader);
  publisher.join();
  EXPECT_EQ(received.size(), 1U);
  EXPECT_EQ(received.at(kImu).size(), 100U);
}

TEST(Live, ALatchedMessageReachesThoseWhoComeLater) {
  const LiveOptions options = live_options();
  LiveWriter writer(options);
  dataset::MessageWriter message;
  dataset::ros::encode_string("mounting", message);
  writer.write(writer.add_topic("/about", dataset::ros::kString, true), Time{1}, Time{1},
               message.bytes());
  LiveReader reader(options,
                    {.topics = {}, .idle = std::chrono::seconds(1), .stopped = after(kLimit)});
  const auto received = reader.next();
  ASSERT_TRUE(received);
  EXPECT_EQ(received->topic, "/about");
  EXPECT_EQ(received->type, dataset::ros::kString);
  EXPECT_EQ(dataset::ros::decode_string(received->data, "test"), "mounting");
}

TEST(Live, AReaderThatIsToldToStopDoesWithoutAnyMessage) {
  LiveReader reader(live_options(), {.topics = {}, .idle = {}, .stopped = [] { return true; }});
  EXPECT_FALSE(reader.next());
}

TEST(LiveNames, AreThoseOfRos2InDdsAndBack) {
  EXPECT_EQ(dds_topic_of("/a/points"), "rt/a/points");
  EXPECT_EQ(ros_topic_of("rt/a/points"), "/a/points");
  EXPECT_EQ(ros_topic_of("DCPSTopic"), "");
  EXPECT_EQ(dds_type_of("sensor_msgs/msg/Imu"), "sensor_msgs::msg::dds_::Imu_");
  EXPECT_EQ(ros_type_of("sensor_msgs::msg::dds_::Imu_"), "sensor_msgs/msg/Imu");
  EXPECT_EQ(ros_type_of("a::B"), "");
}

TEST(LiveNames, ADomainThatIsNoneIsNamed) {
  setenv("ROS_DOMAIN_ID", "kitchen", 1);
  try {
    const Participant participant({});
    ADD_FAILURE() << "no error";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("ROS_DOMAIN_ID: is 'kitchen'"));
  }
  unsetenv("ROS_DOMAIN_ID");
}

}  // namespace
}  // namespace lidarena::dds
