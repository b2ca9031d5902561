// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <functional>

#include "lidarena/base/error.hpp"
#include "lidarena/base/random.hpp"
#include "lidarena/dataset/compression.hpp"
#include "lidarena/dataset/mcap/mcap_info.hpp"
#include "lidarena/dataset/mcap/mcap_reader.hpp"
#include "lidarena/dataset/mcap/mcap_writer.hpp"
#include "tests/dataset/file_helpers.hpp"
#include "tests/dataset/messages.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::dataset {
namespace {

using testing::HasSubstr;

/// Rewrites a file: removed first, because overwriting a file just written makes some file systems
/// wait for the disk.
void rewrite(const std::filesystem::path& file, std::string_view bytes) {
  std::filesystem::remove(file);
  write_file(file, bytes);
}

/// A message as a value.
struct McapMessage {
  std::string topic;
  std::uint32_t sequence = 0;
  Time log_time{0};
  Time publish_time{0};
  std::string data;
  bool operator==(const McapMessage&) const = default;
};

/// 24 messages of random (seeded) content on two topics.
std::vector<McapMessage> sample_mcap_messages() {
  std::vector<McapMessage> messages;
  SequentialRandom random(1);
  std::map<std::string, std::uint32_t> sequences;
  for (int i = 0; i < 24; ++i) {
    const std::string topic = i % 3 == 0 ? "/a" : "/b";
    std::string data(static_cast<std::size_t>(random.uniform(0.0, 30.0)), '\0');
    for (char& c : data) c = static_cast<char>(random.uniform(0.0, 255.0));
    messages.push_back({topic, sequences[topic]++, Time{1000 + 10 * i}, Time{1000 + 9 * i}, data});
  }
  return messages;
}

void write_sample(const std::filesystem::path& file, int zstd_level,
                  const std::function<void(McapWriter&)>& finish = &McapWriter::close) {
  McapWriter out(file, {.profile = "", .zstd_level = zstd_level, .chunk_bytes = 300});
  const std::uint16_t schema = out.add_schema("test", "text", "a definition");
  const std::uint16_t a = out.add_channel("/a", schema, "raw", {{"key", "value"}});
  const std::uint16_t b = out.add_channel("/b", schema, "raw");
  out.add_channel("/silent", 0, "raw");
  out.add_metadata("about", {{"x", "1"}, {"y", "2"}});
  for (const McapMessage& message : sample_mcap_messages()) {
    out.write(message.topic == "/a" ? a : b, message.log_time, message.publish_time,
              std::as_bytes(std::span(message.data)));
  }
  finish(out);
}

/// The messages that can be read, and the error that ended the reading, if any.
struct McapReading {
  std::vector<McapMessage> messages;
  std::string error;
};

McapReading read_sample(const std::filesystem::path& file) {
  McapReading reading;
  try {
    McapReader in(file);
    while (const auto message = in.next()) {
      reading.messages.push_back({message->channel->topic, message->sequence, message->log_time,
                                  message->publish_time, text_of(message->data)});
    }
  } catch (const InputError& error) {
    reading.error = error.what();
  }
  return reading;
}

/// Number of messages of `part` that are not in `whole`, or not in its order.
std::size_t count_unexpected(const std::vector<McapMessage>& part,
                             const std::vector<McapMessage>& whole) {
  std::size_t count = 0;
  auto next = whole.begin();
  for (const McapMessage& message : part) {
    const auto found = std::find(next, whole.end(), message);
    if (found == whole.end()) {
      ++count;
    } else {
      next = found + 1;
    }
  }
  return count;
}

class McapFiles : public testing::TestWithParam<int> {
 protected:
  TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "a.mcap";
};

TEST_P(McapFiles, MessagesComeBackInOrderWithAllTheyCarry) {
  write_sample(file_, GetParam());
  const McapReading reading = read_sample(file_);
  EXPECT_EQ(reading.error, "");
  EXPECT_EQ(reading.messages, sample_mcap_messages());
}

TEST_P(McapFiles, TheSameMessagesGiveTheSameBytes) {
  write_sample(file_, GetParam());
  write_sample(folder_.path() / "b.mcap", GetParam());
  EXPECT_EQ(file_text(file_), file_text(folder_.path() / "b.mcap"));
}

TEST_P(McapFiles, AFileCutAnywhereIsReadUpToTheCutAndSaysSo) {
  write_sample(file_, GetParam());
  const std::string whole = file_text(file_);
  const std::vector<McapMessage> expected = sample_mcap_messages();
  std::size_t max_messages = 0;
  for (std::size_t size = 0; size < whole.size(); ++size) {
    rewrite(file_, std::string_view(whole).substr(0, size));
    const McapReading reading = read_sample(file_);
    ASSERT_NE(reading.error, "") << "cut after " << size;
    EXPECT_THAT(reading.error, HasSubstr(file_.string()));
    if (size > 40) {  // after the header
      EXPECT_THAT(reading.error, HasSubstr("is cut off after " +
                                           std::to_string(reading.messages.size()) + " messages"));
      EXPECT_THAT(reading.error, HasSubstr("byte " + std::to_string(size)));
    }
    ASSERT_TRUE(is_beginning_of(reading.messages, expected)) << "cut after " << size;
    EXPECT_GE(reading.messages.size(),
              max_messages);  // a longer part has at least as many messages
    max_messages = reading.messages.size();
  }
  EXPECT_EQ(max_messages, expected.size());
}

// Every byte is covered by a checksum or by a rule. The messages of a chunk are never returned
// changed. The records around the chunks are covered only by the checksum at the end of the data
// section: until then a chunk with a damaged opcode is skipped, and an index can be taken for a
// message (opcodes 7 and 5).
TEST_P(McapFiles, AFlippedBitAnywhereIsNoticed) {
  write_sample(file_, GetParam());
  const std::string whole = file_text(file_);
  const std::vector<McapMessage> expected = sample_mcap_messages();
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ (1 << (at % 8)));
    rewrite(file_, damaged);
    const McapReading reading = read_sample(file_);
    EXPECT_NE(reading.error, "") << "byte " << at << " of " << whole.size();
    const std::size_t unexpected = count_unexpected(reading.messages, expected);
    EXPECT_LE(unexpected, 1U) << "byte " << at;
    if (unexpected > 0) {
      EXPECT_THAT(reading.error, HasSubstr("the data section's checksum (CRC) is wrong"));
    }
  }
}

TEST_P(McapFiles, SeededDamageOfSeveralBytesNeverCrashesTheReader) {
  write_sample(file_, GetParam());
  const std::string whole = file_text(file_);
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    SequentialRandom random(seed);
    std::string damaged = whole;
    for (int i = 0; i < 8; ++i) {
      const auto at =
          static_cast<std::size_t>(random.uniform() * static_cast<double>(whole.size()));
      damaged[at] = static_cast<char>(random.uniform(0.0, 255.0));
    }
    rewrite(file_, damaged);
    const McapReading reading = read_sample(file_);
    EXPECT_NE(reading.error, "") << seed;
    EXPECT_LE(count_unexpected(reading.messages, sample_mcap_messages()), 8U) << seed;
    try {
      read_mcap_info(file_);
    } catch (const InputError&) {
      // a damaged header
    }
  }
}

TEST_P(McapFiles, TheSummaryAnswersWithoutReadingTheData) {
  write_sample(file_, GetParam());
  const McapInfo info = read_mcap_info(file_);
  EXPECT_TRUE(info.from_summary);
  EXPECT_EQ(info.damage, "");
  EXPECT_EQ(info.message_count, 24U);
  EXPECT_EQ(info.start, Time{1000});
  EXPECT_EQ(info.end, Time{1230});
  EXPECT_EQ(info.count_of("/a"), 8U);
  EXPECT_EQ(info.count_of("/b"), 16U);
  EXPECT_EQ(info.count_of("/silent"), 0U);
  ASSERT_EQ(info.topics.size(), 3U);
  EXPECT_EQ(info.topics[0].type, "test");
  EXPECT_EQ(info.topics[0].message_encoding, "raw");
  EXPECT_EQ(info.metadata.at("about").at("y"), "2");
  EXPECT_GT(info.chunk_count, 3U);
}

TEST_P(McapFiles, WithoutASummaryInfoComesFromReadingAll) {
  write_sample(file_, GetParam());
  const McapInfo from_summary = read_mcap_info(file_);
  write_file(file_, std::string_view(file_text(file_)).substr(0, file_text(file_).size() - 8));
  const McapInfo from_reading = read_mcap_info(file_);
  EXPECT_FALSE(from_reading.from_summary);
  EXPECT_THAT(from_reading.damage, HasSubstr("is cut off after 24 messages"));
  EXPECT_EQ(from_reading.message_count, from_summary.message_count);
  EXPECT_EQ(from_reading.chunk_count, from_summary.chunk_count);
  EXPECT_EQ(from_reading.start, from_summary.start);
  EXPECT_EQ(from_reading.end, from_summary.end);
  EXPECT_EQ(from_reading.metadata, from_summary.metadata);
  EXPECT_EQ(from_reading.count_of("/b"), from_summary.count_of("/b"));
}

TEST_P(McapFiles, WithoutCloseThePartIsThereAndTheFileIsNot) {
  write_sample(file_, GetParam(), [](McapWriter&) {});
  EXPECT_FALSE(exists(file_));
  const McapReading reading = read_sample(folder_.path() / "a.mcap.part");
  EXPECT_THAT(reading.error, HasSubstr("is cut off after"));
  EXPECT_TRUE(is_beginning_of(reading.messages, sample_mcap_messages()));
}

INSTANTIATE_TEST_SUITE_P(StoredAndZstd, McapFiles, testing::Values(0, 1),
                         [](const auto& level) { return "level" + std::to_string(level.param); });

TEST(Mcap, AFullDiskIsNoticedAndNamed) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full: not tested";
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.mcap";
  std::filesystem::create_symlink("/dev/full", folder.path() / "a.mcap.part");
  McapWriter out(file);
  const std::uint16_t channel = out.add_channel("/a", 0, "raw");
  const std::vector<std::byte> data(10'000);
  out.write(channel, Time{0}, Time{0}, data);
  for (int attempt = 0; attempt < 2; ++attempt) {  // the second attempt fails as well
    try {
      out.close();
      FAIL() << "a full disk was not detected";
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), HasSubstr(file.string()));
      if (attempt == 0) {
        EXPECT_THAT(error.what(), HasSubstr("No space left"));
      }
    }
  }
  EXPECT_FALSE(exists(file));
}

TEST(Mcap, AFullDiskIsNoticedWhileWriting) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full: not tested";
  const TemporaryFolder folder;
  std::filesystem::create_symlink("/dev/full", folder.path() / "a.mcap.part");
  McapWriter out(folder.path() / "a.mcap", {.zstd_level = 0});
  const std::uint16_t channel = out.add_channel("/a", 0, "raw");
  const std::vector<std::byte> data(3 << 20);
  EXPECT_THROW(out.write(channel, Time{0}, Time{0}, data), Error);
}

TEST(Mcap, AnEmptyFileIsWhole) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.mcap";
  McapWriter(file).close();
  const McapReading reading = read_sample(file);
  EXPECT_EQ(reading.error, "");
  EXPECT_TRUE(reading.messages.empty());
  EXPECT_EQ(read_mcap_info(file).message_count, 0U);
}

TEST(Mcap, OtherFilesAreRefused) {
  const TemporaryFolder folder;
  folder.write("a.mcap", "#ROSBAG V2.0\n and so on");
  EXPECT_THAT(read_sample(folder.path() / "a.mcap").error, HasSubstr("is not an MCAP file"));
  EXPECT_THAT(read_sample(folder.path() / "missing.mcap").error, HasSubstr("cannot be opened"));
}

TEST(Mcap, NegativeTimesAreRefused) {
  const TemporaryFolder folder;
  McapWriter out(folder.path() / "a.mcap");
  const std::uint16_t channel = out.add_channel("/a", 0, "raw");
  EXPECT_THROW(out.write(channel, Time{-1}, Time{0}, {}), InputError);
}

// A file built record by record according to the specification: messages outside chunks, no
// summary, no checksums.
TEST(Mcap, ReadsMessagesOutsideChunks) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.mcap";
  ByteWriter out;
  out.put(mcap::magic());
  append(out, mcap::Header{"", "by hand"});
  append(out, mcap::Channel{5, 0, "/t", "raw", {}});
  const std::string data = "hello";
  append(out, mcap::Message{5, 9, 12, 13, std::as_bytes(std::span(data))});
  mcap::append_data_end(out, 0);
  append(out, mcap::Footer{});
  out.put(mcap::magic());
  write_file(file, text_of(out.bytes()));
  const McapReading reading = read_sample(file);
  EXPECT_EQ(reading.error, "");
  EXPECT_EQ(reading.messages, (std::vector<McapMessage>{{"/t", 9, Time{12}, Time{13}, "hello"}}));
  EXPECT_FALSE(read_mcap_info(file).from_summary);
}

/// A file with one chunk of records, compressed as stated.
void write_one_chunk(const std::filesystem::path& file, const std::string& compression,
                     Bytes records, std::uint64_t uncompressed_size) {
  ByteWriter out;
  out.put(mcap::magic());
  append(out, mcap::Header{});
  append(out, mcap::Chunk{0, 0, uncompressed_size, 0, compression, records});
  mcap::append_data_end(out, 0);
  append(out, mcap::Footer{});
  out.put(mcap::magic());
  write_file(file, text_of(out.bytes()));
}

TEST(Mcap, AChunkThatLiesAboutItsSizeClaimsNoMemory) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.mcap";
  const std::vector<std::byte> zeros(100);
  write_one_chunk(file, "zstd", ZstdCompressor(1).compress(zeros), std::uint64_t{1} << 60);
  EXPECT_THAT(read_sample(file).error, HasSubstr("holds fewer bytes than stated"));
  write_one_chunk(file, "zstd", ZstdCompressor(1).compress(zeros), 50);
  EXPECT_THAT(read_sample(file).error, HasSubstr("holds more bytes than stated"));
  write_one_chunk(file, "", zeros, 50);
  EXPECT_THAT(read_sample(file).error, HasSubstr("size differs from the stated"));
  write_one_chunk(file, "brotli", zeros, 100);
  EXPECT_THAT(read_sample(file).error, HasSubstr("unknown method 'brotli'"));
}

TEST(Mcap, ReadsLz4Frames) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "a.mcap";
  ByteWriter records;
  append(records, mcap::Channel{1, 0, "/t", "raw", {}});
  const std::string data = "hello";
  append(records, mcap::Message{1, 0, 1, 1, std::as_bytes(std::span(data))});
  // An LZ4 frame with one stored block (LZ4 frame format 1.6.1): magic, FLG version 1 and
  // independent blocks, BD 64 KiB, header checksum, block size with the top bit set, the block,
  // end mark.
  ByteWriter frame;
  frame.put(std::uint32_t{0x184D2204});
  frame.put(std::uint8_t{0x60});
  frame.put(std::uint8_t{0x40});
  frame.put(std::uint8_t{0x82});
  frame.put(static_cast<std::uint32_t>(records.size()) | 0x80000000U);
  frame.put(records.bytes());
  frame.put(std::uint32_t{0});
  write_one_chunk(file, "lz4", frame.bytes(), records.size());
  const McapReading reading = read_sample(file);
  EXPECT_EQ(reading.error, "");
  ASSERT_EQ(reading.messages.size(), 1U);
  EXPECT_EQ(reading.messages[0].data, "hello");
}

TEST(Mcap, TheCheckSumIsCrc32OfIeee) {
  const std::string text = "123456789";  // the usual test value
  const auto bytes = std::as_bytes(std::span(text));
  EXPECT_EQ(crc32_of(bytes), 0xCBF43926U);
  for (const std::size_t cut : {0UL, 4UL, 9UL})
    EXPECT_EQ(crc32_of(bytes.subspan(cut), crc32_of(bytes.first(cut))), 0xCBF43926U);
}

TEST_P(McapFiles, AMessageLargerThanAChunkSharesOneWithThoseBeforeIt) {
  const std::string large(300'000, 'x');
  const std::vector<McapMessage> messages{{"/a", 0, Time{1}, Time{1}, "small"},
                                          {"/a", 1, Time{2}, Time{2}, large},
                                          {"/a", 2, Time{3}, Time{3}, large},
                                          {"/a", 3, Time{4}, Time{4}, "small"}};
  McapWriter out(file_, {.zstd_level = GetParam(), .chunk_bytes = 100'000});
  const std::uint16_t channel = out.add_channel("/a", 0, "raw");
  for (const McapMessage& message : messages) {
    out.write(channel, message.log_time, message.publish_time,
              std::as_bytes(std::span(message.data)));
  }
  out.close();
  const McapReading reading = read_sample(file_);
  EXPECT_EQ(reading.error, "");
  EXPECT_EQ(reading.messages, messages);
  EXPECT_EQ(out.statistics().chunk_count, 3U);
}

}  // namespace
}  // namespace lidarena::dataset
