// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/dataset.hpp"

#include <gmock/gmock.h>

#include <fstream>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/mcap/mcap_reader.hpp"
#include "lidarena/dataset/mcap/mcap_writer.hpp"
#include "lidarena/dataset/messages/ros_messages.hpp"
#include "tests/dataset/event_matching.hpp"
#include "tests/dataset/file_helpers.hpp"
#include "tests/dataset/sample_events.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::dataset {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

ReadOptions only_sensor(const std::string& sensor) {
  ReadOptions options;
  options.sensor = sensor;
  return options;
}

/// Writes `events` and ground truth to a dataset folder; with `finished` false, as after a crash.
void write_dataset(const fs::path& folder, const std::vector<Event>& events, bool finished = true) {
  DatasetWriter out(folder, sample::rig());
  int next_truth = 0;
  for (const Event& event : events) {
    if (std::holds_alternative<ImuSample>(event.data)) out.write_truth(sample::truth(next_truth++));
    out.write(event);
  }
  if (finished) out.finish({{"seed", 42}});
}

void expect_same_rig(const Rig& a, const Rig& b) {
  ASSERT_EQ(a.lidars.size(), b.lidars.size());
  ASSERT_EQ(a.imus.size(), b.imus.size());
  EXPECT_EQ(a.body_frame, b.body_frame);
  for (std::size_t i = 0; i < a.lidars.size(); ++i) {
    EXPECT_EQ(a.lidars[i].id, b.lidars[i].id);
    EXPECT_EQ(a.lidars[i].model, b.lidars[i].model);
    EXPECT_TRUE(a.lidars[i].body_from_lidar.isApprox(b.lidars[i].body_from_lidar, 1e-15));
  }
  for (std::size_t i = 0; i < a.imus.size(); ++i) {
    EXPECT_EQ(a.imus[i].id, b.imus[i].id);
    EXPECT_TRUE(a.imus[i].body_from_imu.isApprox(b.imus[i].body_from_imu, 1e-15));
  }
}

class DatasetFolder : public testing::Test {
 protected:
  TemporaryFolder temporary_;
  fs::path folder_ = temporary_.path() / "flight";
  std::vector<Event> events_ = sample::events(5, 300);
};

TEST_F(DatasetFolder, EveryFieldOfEveryEventComesBackInTheSameOrder) {
  write_dataset(folder_, events_);
  Dataset dataset = open_dataset(folder_);
  expect_same(drain(*dataset.events), events_);
  expect_same_rig(dataset.rig, sample::rig());
  EXPECT_EQ(dataset.scan_count, 5U);
  EXPECT_EQ(dataset.manifest.at("seed"), 42);
}

TEST_F(DatasetFolder, TheDataFileAloneIsADatasetToo) {
  write_dataset(folder_, events_);
  Dataset dataset = open_dataset(folder_ / "data.mcap");
  expect_same(drain(*dataset.events), events_);
  expect_same_rig(dataset.rig, sample::rig());
  EXPECT_TRUE(dataset.manifest.is_null());
}

TEST_F(DatasetFolder, HasTheFilesOfTheContractAndNoLeftovers) {
  write_dataset(folder_, events_);
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder_)) {
    names.push_back(entry.path().filename().string());
  }
  EXPECT_THAT(names, testing::UnorderedElementsAre("data.mcap", "truth.tum", "manifest.json",
                                                   "metadata.yaml"));
}

TEST_F(DatasetFolder, TheSameEventsGiveTheSameBytes) {
  write_dataset(folder_, events_);
  write_dataset(temporary_.path() / "again", events_);
  for (const char* name : {"data.mcap", "truth.tum", "manifest.json", "metadata.yaml"}) {
    EXPECT_EQ(file_text(folder_ / name), file_text(temporary_.path() / "again" / name)) << name;
  }
}

TEST_F(DatasetFolder, TruthComesApartAndIsNotAmongTheEvents) {
  write_dataset(folder_, events_);
  for (const fs::path& path : {folder_, folder_ / "data.mcap"}) {
    const std::optional<Trajectory> truth = load_truth(path);
    ASSERT_TRUE(truth.has_value());
    ASSERT_GT(truth->size(), 100U);
    const StampedPose expected = sample::truth(50);
    EXPECT_EQ(truth->poses()[50].stamp, expected.stamp);
    // TUM files keep 9 significant digits
    EXPECT_TRUE(truth->poses()[50].world_from_body.isApprox(expected.world_from_body, 1e-8));
  }
}

TEST_F(DatasetFolder, AnInterruptedOneIsCalledUnfinished) {
  write_dataset(folder_, events_, false);
  try {
    open_dataset(folder_);
    FAIL() << "an unfinished dataset was opened";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("is an unfinished dataset: it has no manifest.json"));
  }
  // Its data can still be read, up to the point where they stop.
  Dataset part = open_dataset(folder_ / "data.mcap.part");
  EXPECT_THAT(part.notes, testing::Contains(HasSubstr("is cut off after")));
  EXPECT_THROW(drain(*part.events), InputError);
}

TEST_F(DatasetFolder, WritingAgainWithdrawsTheOldManifestFirst) {
  write_dataset(folder_, events_);
  write_dataset(folder_, events_, false);
  EXPECT_THROW(open_dataset(folder_), InputError);
  EXPECT_FALSE(fs::exists(folder_ / "truth.tum"));
}

TEST_F(DatasetFolder, ACutDataFileGivesTheEventsBeforeTheCut) {
  write_dataset(folder_, sample::events(40, 8000));  // several chunks
  const auto size = fs::file_size(folder_ / "data.mcap");
  fs::resize_file(folder_ / "data.mcap", size * 2 / 3);
  Dataset dataset = open_dataset(folder_);
  EXPECT_FALSE(dataset.scan_count.has_value());
  std::size_t scans = 0;
  try {
    while (auto event = dataset.events->next()) scans += std::holds_alternative<Scan>(event->data);
    FAIL() << "the cut was not detected";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("is cut off after"));
  }
  EXPECT_GT(scans, 5U);
  EXPECT_LT(scans, 40U);
}

TEST_F(DatasetFolder, ReadersThatSortByLogTimeKeepTheOrder) {
  write_dataset(folder_, events_);
  McapReader in(folder_ / "data.mcap");
  Time latest{0};
  while (const auto message = in.next()) {
    EXPECT_GE(message->log_time, latest) << message->channel->topic;
    EXPECT_GE(message->log_time, message->publish_time);
    latest = message->log_time;
  }
}

/// ROS 1 takes a log time of 0 for an invalid one: its player drops such messages.
TEST_F(DatasetFolder, NoMessageIsLoggedAtTimeZero) {
  DatasetWriter out(folder_, sample::rig());
  out.write_truth({Time{0}, Pose::Identity()});
  out.write({"mid360", ImuSample{}});
  out.finish({});
  McapReader in(folder_ / "data.mcap");
  int messages = 0;
  for (; const auto message = in.next(); ++messages) EXPECT_GT(message->log_time, Time{0});
  EXPECT_EQ(messages, 4) << "mounting, truth as odometry and as transform, sample";
}

TEST_F(DatasetFolder, TransformsAndTruthAreInTheBagForRos) {
  write_dataset(folder_, events_);
  McapReader in(folder_ / "data.mcap");
  std::map<std::string, int> counts;
  while (const auto message = in.next()) {
    const std::string& topic = message->channel->topic;
    if (counts[topic]++ > 0) continue;
    if (topic == "/tf_static") {
      const auto mounting = ros::decode_transforms(message->data, topic);
      ASSERT_EQ(mounting.size(), 2U);
      EXPECT_EQ(mounting[0].parent, "base_link");
      EXPECT_EQ(mounting[0].child, "mid360_lidar");
      EXPECT_EQ(mounting[1].child, "mid360_imu");
      EXPECT_TRUE(mounting[0].parent_from_child.isApprox(sample::rig().lidars[0].body_from_lidar));
    } else if (topic == "/tf") {
      const auto pose = ros::decode_transforms(message->data, topic);
      ASSERT_EQ(pose.size(), 1U);
      EXPECT_EQ(pose[0].parent, "world");
      EXPECT_EQ(pose[0].child, "base_link");
    }
  }
  EXPECT_EQ(counts["/tf_static"], 1);
  EXPECT_EQ(counts["/mid360/points"], 5);
  EXPECT_GT(counts["/mid360/imu"], 100);
  EXPECT_EQ(counts["/tf"], counts["/mid360/imu"]);
  EXPECT_EQ(counts["/truth/odometry"], counts["/mid360/imu"]);
}

TEST_F(DatasetFolder, MetadataForRosbag2CountsWhatIsInTheFile) {
  write_dataset(folder_, events_);
  const ConfigNode info =
      *ConfigNode::load(folder_ / "metadata.yaml").find("rosbag2_bagfile_information");
  EXPECT_EQ(info.find("version")->as_integer(), 5);
  EXPECT_EQ(info.find("storage_identifier")->text(), "mcap");
  EXPECT_EQ(info.find("relative_file_paths")->items().at(0).text(), "data.mcap");
  std::int64_t sum = 0;
  for (const ConfigNode& topic : info.find("topics_with_message_count")->items()) {
    sum += topic.find("message_count")->as_integer();
    const ConfigNode metadata = *topic.find("topic_metadata");
    EXPECT_EQ(metadata.find("serialization_format")->text(), "cdr");
    if (metadata.find("name")->text() == "/tf_static") {
      const ConfigNode qos =
          ConfigNode::parse(metadata.find("offered_qos_profiles")->text(), "qos").items().at(0);
      EXPECT_EQ(qos.find("durability")->as_integer(), 1);  // transient local
      EXPECT_EQ(qos.find("reliability")->as_integer(), 1);
    }
  }
  McapReader in(folder_ / "data.mcap");
  while (in.next()) {
  }
  EXPECT_EQ(sum, static_cast<std::int64_t>(in.statistics().message_count));
  EXPECT_EQ(info.find("message_count")->as_integer(), sum);
  EXPECT_EQ(in.metadata().at("rosbag2").at("serialized_metadata"),
            file_text(folder_ / "metadata.yaml"));
}

TEST_F(DatasetFolder, ASensorOutsideTheRigIsBadInput) {
  DatasetWriter out(folder_, sample::rig());
  EXPECT_THROW(out.write({"other", ImuSample{}}), InputError);
}

TEST_F(DatasetFolder, OneLidarOfSeveralCanBeAskedFor) {
  Rig rig = sample::rig();
  rig.lidars.push_back(rig.lidars[0]);
  rig.lidars[1].id = "os0";
  DatasetWriter out(folder_, rig);
  for (const Event& event : events_) {
    out.write(event);
    if (std::holds_alternative<Scan>(event.data)) out.write({"os0", event.data});
  }
  out.close();
  const Pose mounted = make_pose(Eigen::Quaterniond::Identity(), Eigen::Vector3d(1, 2, 3));
  ReadOptions options = only_sensor("os0");
  options.body_from_lidar = mounted;
  Dataset dataset = open_dataset(folder_, options);
  ASSERT_EQ(dataset.rig.lidars.size(), 1U);
  EXPECT_TRUE(dataset.rig.lidars[0].body_from_lidar.isApprox(mounted));
  EXPECT_EQ(dataset.scan_count, 5U);
  for (const Event& event : drain(*dataset.events)) {
    if (std::holds_alternative<Scan>(event.data)) {
      EXPECT_EQ(event.sensor_id, "os0");
    }
  }
  EXPECT_THROW(open_dataset(folder_, only_sensor("os1")), InputError);
  options.sensor.clear();  // ambiguous: body_from_lidar with two LiDARs
  EXPECT_THROW(open_dataset(folder_, options), InputError);
  EXPECT_FALSE(open_dataset(folder_).scan_count.has_value());
}

TEST_F(DatasetFolder, FoldersThatAreNoDatasetAreRefused) {
  fs::create_directories(folder_);
  EXPECT_THROW(open_dataset(folder_ / "missing"), InputError);
  std::ofstream(folder_ / "manifest.json") << "{\"algorithm\": \"kiss_icp\"}";
  EXPECT_THROW(open_dataset(folder_), InputError);
  std::ofstream(folder_ / "manifest.json") << "[1, 2]";
  EXPECT_THROW(open_dataset(folder_), InputError);
  std::ofstream(folder_ / "manifest.json") << "{\"format\": ";
  EXPECT_THROW(open_dataset(folder_), InputError);
  std::ofstream(folder_ / "manifest.json")
      << R"({"format": "lidarena dataset", "format_version": 1})";
  EXPECT_THROW(open_dataset(folder_), InputError);  // a manifest without data
}

/// Writes a third-party recording: other topics and frames, scans logged at their start.
void write_foreign(const fs::path& file, const std::vector<Event>& events) {
  McapWriter out(file);
  const auto schema = [&](std::string_view type) {
    return out.add_schema(std::string(type), "ros2msg", ros::definition_of(type));
  };
  const std::uint16_t imu = out.add_channel("/os/imu", schema(ros::kImu), "cdr");
  const std::uint16_t points = out.add_channel("/os/points", schema(ros::kPointCloud2), "cdr");
  const std::uint16_t derived = out.add_channel("/map", schema(ros::kPointCloud2), "cdr");
  MessageWriter message;
  for (const Event& event : events) {
    if (const auto* sample = std::get_if<ImuSample>(&event.data)) {
      ros::encode_imu(*sample, "os_imu", message);
      out.write(imu, sample->stamp, sample->stamp, message.bytes());
    } else {
      const Scan& scan = std::get<Scan>(event.data);
      ros::encode_scan(scan, "os_lidar", message);
      out.write(points, scan.stamp, scan.stamp, message.bytes());
      out.write(derived, scan.stamp, scan.stamp, message.bytes());
    }
  }
  out.close();
}

TEST(ForeignMcap, TopicsAreFoundByTypeAndInferencesAreNoted) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "other.mcap";
  write_foreign(file, sample::events(3, 50));
  Dataset dataset = open_dataset(file);
  ASSERT_EQ(dataset.rig.lidars.size(), 1U);
  EXPECT_EQ(dataset.rig.lidars[0].id, "os");
  ASSERT_EQ(dataset.rig.imus.size(), 1U);
  EXPECT_TRUE(dataset.rig.lidars[0].body_from_lidar.isApprox(Pose::Identity()));
  EXPECT_EQ(dataset.scan_count, 3U);
  EXPECT_THAT(dataset.notes, testing::Contains(HasSubstr("/os/points")));
  EXPECT_THAT(dataset.notes, testing::Contains(HasSubstr("mounted")));
  EXPECT_FALSE(load_truth(file).has_value());
}

TEST(ForeignMcap, AnotherTopicCanBeNamed) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "other.mcap";
  write_foreign(file, sample::events(3, 50));
  EXPECT_EQ(open_dataset(file, only_sensor("/map")).rig.lidars.at(0).id, "map");
  EXPECT_THROW(open_dataset(file, only_sensor("/none")), InputError);
}

TEST(ForeignMcap, AFolderOfRosbag2IsOpenedByItsFile) {
  const TemporaryFolder folder;
  write_foreign(folder.path() / "bag_0.mcap", sample::events(3, 50));
  folder.write("metadata.yaml", "rosbag2_bagfile_information: {}\n");
  EXPECT_EQ(open_dataset(folder.path()).scan_count, 3U);
}

TEST(ForeignMcap, ABagWithoutItsDataSaysSo) {
  const TemporaryFolder folder;
  folder.write("metadata.yaml", "rosbag2_bagfile_information: {}\n");
  EXPECT_THAT(input_error([&] { open_dataset(folder.path()); }), HasSubstr("without its data"));
}

TEST(ForeignMcap, WithoutScansTheErrorListsWhatThereIs) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "other.mcap";
  McapWriter out(file);
  const std::uint16_t channel =
      out.add_channel("/camera", out.add_schema("sensor_msgs/msg/Image", "ros2msg", ""), "cdr");
  out.write(channel, Time{0}, Time{0}, {});
  out.close();
  try {
    open_dataset(file);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("/camera (sensor_msgs/msg/Image in cdr)"));
  }
}

}  // namespace
}  // namespace lidarena::dataset
