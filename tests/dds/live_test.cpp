// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "lidarena/base/error.hpp"
#include "tests/dds/live_helpers.hpp"

namespace lidarena::dds {
namespace {

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
