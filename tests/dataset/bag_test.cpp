// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <functional>
#include <stdexcept>

#include "lidarena/base/error.hpp"
#include "lidarena/base/random.hpp"
#include "lidarena/dataset/compression.hpp"
#include "lidarena/dataset/dataset.hpp"
#include "lidarena/dataset/messages/ros_messages.hpp"
#include "lidarena/dataset/ros1/bag_reader.hpp"
#include "lidarena/dataset/ros1/bag_records.hpp"
#include "lidarena/dataset/ros1/bag_writer.hpp"
#include "tests/dataset/event_matching.hpp"
#include "tests/dataset/file_helpers.hpp"
#include "tests/dataset/messages.hpp"
#include "tests/dataset/sample_events.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::dataset {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// A message as a value.
struct BagMessage {
  std::string topic;
  std::string type;
  Time time{0};
  std::string data;
  bool operator==(const BagMessage&) const = default;
};

/// 60 strings of random (seeded) length and content on two topics.
std::vector<BagMessage> sample_bag_messages() {
  std::vector<BagMessage> messages;
  SequentialRandom random(1);
  MessageWriter message(Encoding::kRos1);
  for (int i = 0; i < 60; ++i) {
    std::string text(static_cast<std::size_t>(random.uniform(0.0, 60.0)), 'a');
    for (char& c : text) c = static_cast<char>(random.uniform(32.0, 127.0));
    ros::encode_string(text, message);
    messages.push_back({i % 3 == 0 ? "/a" : "/b", std::string(ros::kString),
                        Time{1'999'999'990 + 7 * i}, text_of(message.bytes())});
  }
  return messages;
}

void write_sample(const fs::path& file, BagCompression compression,
                  const std::function<void(BagWriter&)>& finish = &BagWriter::close) {
  BagWriter out(file, {.compression = compression, .chunk_bytes = 700});
  const std::uint16_t a = out.add_topic("/a", ros::kString, true);
  const std::uint16_t b = out.add_topic("/b", ros::kString);
  out.add_topic("/silent", ros::kImu);
  for (const BagMessage& message : sample_bag_messages()) {
    out.write(message.topic == "/a" ? a : b, message.time, message.time,
              std::as_bytes(std::span(message.data)));
  }
  finish(out);
}

/// The messages that can be read, and the error that ended the reading, if any.
struct BagReading {
  std::vector<BagMessage> messages;
  std::string error;
};

BagReading read_all(const fs::path& file) {
  BagReading reading;
  try {
    BagReader in(file);
    while (const auto message = in.next()) {
      reading.messages.push_back({std::string(message->topic), std::string(message->type),
                                  message->log_time, text_of(message->data)});
    }
  } catch (const InputError& error) {
    reading.error = error.what();
  }
  return reading;
}

/// Whether all of `part` is in `whole`, in its order.
bool is_part_of(const std::vector<BagMessage>& part, const std::vector<BagMessage>& whole) {
  auto next = whole.begin();
  for (const BagMessage& message : part) {
    next = std::find(next, whole.end(), message);
    if (next == whole.end()) return false;
    ++next;
  }
  return true;
}

class BagFiles : public testing::TestWithParam<BagCompression> {
 protected:
  TemporaryFolder folder_;
  fs::path file_ = folder_.path() / "a.bag";
};

TEST_P(BagFiles, MessagesComeBackInOrder) {
  write_sample(file_, GetParam());
  const BagReading reading = read_all(file_);
  EXPECT_EQ(reading.error, "");
  EXPECT_EQ(reading.messages, sample_bag_messages());
}

TEST_P(BagFiles, TheIndexTellsWhatAReadingFinds) {
  write_sample(file_, GetParam());
  const RecordingInfo info = read_bag_info(file_);
  EXPECT_TRUE(info.from_summary);
  EXPECT_EQ(info.message_count, 60U);
  EXPECT_EQ(info.count_of("/a"), 20U);
  EXPECT_EQ(info.count_of("/b"), 40U);
  EXPECT_GT(info.chunk_count, 3U);
  EXPECT_EQ(info.start, sample_bag_messages().front().time);
  EXPECT_EQ(info.end, sample_bag_messages().back().time);
  BagReader reader(file_);
  while (reader.next()) {
  }
  EXPECT_EQ(reader.info().chunk_count, info.chunk_count);
  EXPECT_EQ(reader.info().count_of("/b"), 40U);
  EXPECT_EQ(reader.info().start, info.start);
}

// As the format requires: header and padding of the bag header record take 4096 bytes, in addition
// to their two lengths, so that the first chunk starts at byte 4117.
TEST_P(BagFiles, StartsAsTheFormatSays) {
  write_sample(file_, GetParam());
  const std::string bytes = file_text(file_);
  ASSERT_TRUE(bytes.starts_with("#ROSBAG V2.0\n"));
  std::uint32_t header = 0;
  std::memcpy(&header, bytes.data() + 13, sizeof header);
  const bag::Fields fields(std::as_bytes(std::span(bytes)).subspan(17, header));
  EXPECT_EQ(fields.op(), bag::Op::kBagHeader);
  EXPECT_EQ(fields.number<std::uint32_t>("conn_count"), 2U);  // only those with messages
  std::memcpy(&header, bytes.data() + 4117, sizeof header);
  const bag::Fields chunk(std::as_bytes(std::span(bytes)).subspan(4121, header));
  EXPECT_EQ(chunk.op(), bag::Op::kChunk);
  EXPECT_EQ(chunk.text("compression"), GetParam() == BagCompression::kLz4 ? "lz4" : "none");
}

TEST_P(BagFiles, WithoutCloseTheMessagesCanBeHadAndTheMissingIndexIsNamed) {
  write_sample(file_, GetParam(), [](BagWriter&) {});
  EXPECT_FALSE(fs::exists(file_));
  const BagReading reading = read_all(file_.string() + ".part");
  EXPECT_THAT(reading.error, HasSubstr("was never closed"));
  EXPECT_GT(reading.messages.size(), 30U);
  EXPECT_TRUE(is_beginning_of(reading.messages, sample_bag_messages()));
  EXPECT_THAT(read_bag_info(file_.string() + ".part").damage, HasSubstr("was never closed"));
}

TEST_P(BagFiles, ACutAnywhereIsNoticedAndWhatComesBeforeIsGivenOut) {
  write_sample(file_, GetParam());
  const std::string bytes = file_text(file_);
  const std::vector<BagMessage> whole = sample_bag_messages();
  std::size_t longest = 0;
  for (std::size_t size = 0; size < bytes.size(); size += size < 4100 ? 101 : 3) {
    fs::remove(file_);
    write_file(file_, std::string_view(bytes).substr(0, size));
    const BagReading reading = read_all(file_);
    ASSERT_NE(reading.error, "") << "cut to " << size;
    ASSERT_TRUE(is_beginning_of(reading.messages, whole)) << "cut to " << size;
    ASSERT_GE(reading.messages.size(), longest);
    longest = reading.messages.size();
  }
  EXPECT_EQ(longest, whole.size());  // a cut in the index loses no message
}

// Uncompressed chunks have no checksum: a flipped bit in a message's text cannot be detected.
TEST_P(BagFiles, DamageNeverCrashesAndLz4ChunksAreGivenOutUnchangedOrNotAtAll) {
  write_sample(file_, GetParam());
  const std::string bytes = file_text(file_);
  const std::vector<BagMessage> whole = sample_bag_messages();
  SequentialRandom random(7);
  int detected = 0;
  int info_errors = 0;
  constexpr int kTrials = 400;
  for (int i = 0; i < kTrials; ++i) {
    std::string damaged = bytes;
    const auto at =
        13 + static_cast<std::size_t>(random.uniform(0.0, static_cast<double>(bytes.size() - 14)));
    damaged[at] = static_cast<char>(damaged[at] ^ (1 << (i % 8)));
    fs::remove(file_);
    write_file(file_, damaged);
    const BagReading reading = read_all(file_);
    detected += reading.error.empty() ? 0 : 1;
    if (GetParam() == BagCompression::kLz4) {
      ASSERT_TRUE(is_part_of(reading.messages, whole)) << "trial " << i;
    }
    try {
      read_bag_info(file_);
    } catch (const InputError&) {
      ++info_errors;
    }
  }
  EXPECT_LT(info_errors, detected);  // only a damaged bag header makes read_bag_info() throw
  EXPECT_GT(detected, kTrials / 10);
}

INSTANTIATE_TEST_SUITE_P(Compressions, BagFiles,
                         testing::Values(BagCompression::kNone, BagCompression::kLz4),
                         [](const auto& param) {
                           return param.param == BagCompression::kLz4 ? "Lz4" : "None";
                         });

TEST(Bags, OfOtherKindsAreNamed) {
  const TemporaryFolder folder;
  const auto error_message = [&](std::string_view bytes) {
    const fs::path file = folder.path() / "b.bag";
    fs::remove(file);
    write_file(file, bytes);
    return input_error([&] { BagReader reader(file); });
  };
  EXPECT_THAT(error_message("#ROSBAG V1.2\nxxxxxxx"), HasSubstr("not of version 2.0"));
  EXPECT_THAT(error_message("PK\x03\x04 something else"), HasSubstr("is not a ROS 1 bag"));
  EXPECT_THAT(error_message("#ROSBAG V2.0\n"), HasSubstr("cut off"));
  EXPECT_THAT(input_error([&] { BagReader reader(folder.path() / "none.bag"); }),
              HasSubstr("cannot be opened"));
}

TEST(Bags, TakeNoTimeBeforeTheEpoch) {
  const TemporaryFolder folder;
  BagWriter out(folder.path() / "a.bag");
  const std::uint16_t topic = out.add_topic("/a", ros::kString);
  EXPECT_THROW(out.write(topic, Time{-1}, Time{0}, {}), InputError);
  EXPECT_THROW(out.write(topic, std::chrono::seconds(5'000'000'000), Time{0}, {}), InputError);
}

TEST(Bags, OfDatasetsComeBackEventByEventWithTheirRigAndTruth) {
  const TemporaryFolder folder;
  const std::vector<Event> events = sample::events(5, 300);
  for (const char* name : {"flight", "alone.bag"}) {
    const fs::path path = folder.path() / name;
    DatasetWriter out(path, sample::rig(), {.format = DatasetFormat::kBag});
    int next_truth = 0;
    for (const Event& event : events) {
      if (std::holds_alternative<ImuSample>(event.data)) {
        out.write_truth(sample::truth(next_truth++));
      } else {
        out.write(ScanTruth{"mid360", std::get<Scan>(event.data).stamp, {PointTruth{}}});
      }
      out.write(event);
    }
    out.close();
    EXPECT_EQ(fs::exists(folder.path() / "flight" / "data.bag"), true);
    Dataset dataset = open_dataset(path);
    EXPECT_EQ(dataset.scan_count, 5U);
    ASSERT_EQ(dataset.rig.lidars.size(), 1U);
    EXPECT_EQ(dataset.rig.lidars[0].model, "livox_mid360");
    EXPECT_THAT(dataset.notes, testing::IsEmpty());
    expect_same(drain(*dataset.events), events);
    ASSERT_TRUE(load_truth(path).has_value());
    EXPECT_EQ(load_truth(path)->size(), static_cast<std::size_t>(next_truth));
    const auto truth = open_scan_truth(path);
    ASSERT_NE(truth, nullptr);
    EXPECT_EQ(truth->next()->points.size(), 1U);
  }
}

TEST(Bags, OfADatasetThatWasCutGiveTheEventsBefore) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "data.bag";
  DatasetWriter out(file, sample::rig());
  for (const Event& event : sample::events(40, 4000)) out.write(event);
  out.close();
  fs::resize_file(file, fs::file_size(file) * 2 / 3);
  Dataset dataset = open_dataset(file);
  EXPECT_THAT(dataset.notes, testing::Contains(HasSubstr("is cut off after")));
  std::size_t scans = 0;
  const std::string error_message = input_error([&] {
    while (auto event = dataset.events->next()) scans += std::holds_alternative<Scan>(event->data);
  });
  EXPECT_THAT(error_message, HasSubstr("is cut off after"));
  EXPECT_GT(scans, 5U);
  EXPECT_LT(scans, 40U);
}

TEST(Lz4, FramesComeBackAndDamageIsFound) {
  std::string text;
  for (int i = 0; i < 3000; ++i) text += std::to_string(i * i);
  std::vector<std::byte> packed;
  const Bytes frame = compress_lz4(std::as_bytes(std::span(text)), packed);
  EXPECT_LT(frame.size(), text.size());
  std::vector<std::byte> unpacked;
  decompress("lz4", frame, text.size(), unpacked);
  EXPECT_EQ(text_of(unpacked), text);
  packed[frame.size() / 2] ^= std::byte{4};
  EXPECT_THROW(decompress("lz4", frame, text.size(), unpacked), std::runtime_error);
}

}  // namespace
}  // namespace lidarena::dataset
