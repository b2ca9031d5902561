// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/ros1/bag_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <map>
#include <stdexcept>
#include <vector>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/compression.hpp"
#include "lidarena/dataset/damaged_file.hpp"
#include "lidarena/dataset/messages/ros_messages.hpp"
#include "lidarena/dataset/ros1/bag_records.hpp"

namespace lidarena::dataset {

using bag::Fields;
using bag::Op;

namespace {

/// One record of a chunk.
struct InnerRecord {
  Fields fields;
  Bytes data;
};

InnerRecord next_record(ByteReader& in) {
  Fields fields(in.take(in.get<std::uint32_t>()));
  return {std::move(fields), in.take(in.get<std::uint32_t>())};
}

}  // namespace

struct BagReader::Impl {
  explicit Impl(const std::filesystem::path& file);

  std::string place;
  std::ifstream in;
  std::uint64_t file_size = 0;
  std::uint64_t offset = 0;         ///< of the next byte to read
  std::uint64_t record_offset = 0;  ///< of the top-level record being read
  bool at_end = false;

  // the bag header
  std::uint64_t index_position = 0;  ///< 0: the bag was never closed
  std::uint32_t connection_count = 0;
  std::uint32_t chunk_count = 0;
  std::uint32_t chunk_infos = 0;       ///< chunk info records in the index
  std::uint64_t messages_indexed = 0;  ///< sum of their message counts

  std::vector<std::byte> header;
  Bytes data;                          ///< of the top-level record being read, in `data_buffer`
  std::vector<std::byte> data_buffer;  ///< only grows: new bytes of a vector are cleared first
  std::vector<std::byte> unpacked;     ///< of a compressed chunk
  ByteReader chunk{Bytes{}};           ///< unread rest of the current chunk

  std::map<std::uint32_t, std::size_t> connections;  ///< id -> index in met.topics
  RecordingInfo contents;

  std::string at(std::uint64_t byte) const { return fmt::format("{}: byte {}", place, byte); }
  [[noreturn]] void cut_off() const;
  [[noreturn]] void damaged(std::string_view what) const;
  void read(std::span<std::byte> bytes);
  std::uint32_t read_length();
  Fields read_record();
  void read_bag_header();
  void add_connection(const Fields& fields, Bytes description);
  void open_chunk(const Fields& fields);
  RecordedMessage message(const Fields& fields, Bytes content);
  std::optional<RecordedMessage> take(const Fields& fields, Bytes content);
  void check_end() const;
};

BagReader::Impl::Impl(const std::filesystem::path& file)
    : place(file.string()), in(file, std::ios::binary) {
  std::error_code error;
  file_size = std::filesystem::file_size(file, error);
  if (!in || error) throw InputError(place, "cannot be opened", "check the path");
  if (file_size == 0) throw InputError(place, "is empty", "nothing was recorded; record it again");
  std::string magic(bag::kMagic.size(), '\0');
  in.read(magic.data(), static_cast<std::streamsize>(magic.size()));
  if (magic != bag::kMagic) {
    if (is_bag(magic)) {
      throw InputError(place, "is a bag, but not of version 2.0", "convert it with 'rosbag fix'");
    }
    throw InputError(place, "is not a ROS 1 bag: it does not start with '#ROSBAG V2.0'",
                     "give a .bag file");
  }
  offset = magic.size();
  try {
    read_bag_header();
  } catch (const std::out_of_range&) {
    damaged("the bag header is damaged");
  }
}

void BagReader::Impl::cut_off() const {
  throw DamagedFile(
      at(file_size), fmt::format("the bag is cut off after {} messages", contents.message_count),
      "the messages before this byte are intact; the recording was stopped, copied in "
      "part, or the disk was full");
}

void BagReader::Impl::damaged(std::string_view what) const {
  throw DamagedFile(at(record_offset),
                    fmt::format("{} (after {} messages)", what, contents.message_count),
                    "the messages before this byte are intact; copy the file again");
}

void BagReader::Impl::read(std::span<std::byte> bytes) {
  if (bytes.size() > file_size - offset) cut_off();  // before any size in the file is trusted
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!in) throw InputError(at(offset), "cannot be read", "check the disk");
  offset += bytes.size();
}

std::uint32_t BagReader::Impl::read_length() {
  std::uint32_t length = 0;
  read(std::as_writable_bytes(std::span(&length, 1)));
  if (length > file_size - offset) cut_off();
  return length;
}

/// Reads one top-level record: returns its header fields and leaves its data in `data`.
Fields BagReader::Impl::read_record() {
  record_offset = offset;
  header.resize(read_length());
  read(header);
  const std::uint32_t length = read_length();
  if (length > data_buffer.size()) data_buffer.resize(length);
  const std::span<std::byte> bytes = std::span(data_buffer).first(length);
  read(bytes);
  data = bytes;
  return Fields(header);
}

void BagReader::Impl::read_bag_header() {
  const Fields fields = read_record();
  if (fields.op() != Op::kBagHeader) damaged("the first record is not a bag header");
  if (fields.has("encryptor") && !fields.text("encryptor").empty()) {
    throw InputError(place, "is encrypted", "decrypt it with 'rosbag decrypt'");
  }
  index_position = fields.number<std::uint64_t>("index_pos");
  connection_count = fields.number<std::uint32_t>("conn_count");
  chunk_count = fields.number<std::uint32_t>("chunk_count");
}

void BagReader::Impl::add_connection(const Fields& fields, Bytes description) {
  const auto id = fields.number<std::uint32_t>("conn");
  const std::string topic = fields.text("topic");
  const auto [entry, is_new] = connections.try_emplace(id, contents.topics.size());
  if (is_new) {
    contents.topics.push_back({topic, ros::ros2_name(Fields(description).text("type")), "ros1", 0});
  } else if (contents.topics[entry->second].topic != topic) {
    damaged(fmt::format("connection {} is declared for both {} and {}", id,
                        contents.topics[entry->second].topic, topic));
  }
}

void BagReader::Impl::open_chunk(const Fields& fields) {
  const std::string method = fields.text("compression");
  const auto size = fields.number<std::uint32_t>("size");
  Bytes records = data;
  if (method != "none") {
    try {
      decompress(method, data, size, unpacked);
    } catch (const std::runtime_error& error) {
      damaged(fmt::format("the chunk {}", error.what()));
    }
    records = unpacked;
  }
  if (records.size() != size) damaged("the chunk's size differs from the stated size");
  chunk = ByteReader(records);
  ++contents.chunk_count;
}

RecordedMessage BagReader::Impl::message(const Fields& fields, Bytes content) {
  const auto connection = connections.find(fields.number<std::uint32_t>("conn"));
  if (connection == connections.end()) {
    damaged("a message belongs to a connection that was never declared");
  }
  const Time time = fields.time("time");
  contents.start = contents.message_count == 0 ? time : std::min(contents.start, time);
  contents.end = std::max(contents.end, time);
  ++contents.message_count;
  RecordedTopic& topic = contents.topics[connection->second];
  ++topic.message_count;
  return {topic.topic, topic.type, Encoding::kRos1, time, content};
}

/// Handles one record of the file or of a chunk; returns the message if it is one.
std::optional<RecordedMessage> BagReader::Impl::take(const Fields& fields, Bytes content) {
  switch (fields.op()) {
    case Op::kMessage:
      return message(fields, content);
    case Op::kConnection:
      add_connection(fields, content);
      break;
    case Op::kChunkInfo: {
      ++chunk_infos;
      ByteReader counts(content);
      for (auto n = fields.number<std::uint32_t>("count"); n > 0; --n) {
        counts.get<std::uint32_t>();  // connection
        messages_indexed += counts.get<std::uint32_t>();
      }
      break;
    }
    case Op::kIndex:
      break;  // reading in order does not need it
    default:
      damaged(fmt::format("a record has the unknown opcode {}", static_cast<int>(fields.op())));
  }
  return std::nullopt;
}

void BagReader::Impl::check_end() const {
  if (index_position == 0) {
    throw DamagedFile(at(file_size),
                      fmt::format("the bag was never closed: it has no index and may lack messages "
                                  "after the {} it holds",
                                  contents.message_count),
                      "these messages are intact; 'rosbag reindex' makes a complete bag of them");
  }
  if (chunk_infos < chunk_count || connections.size() < connection_count) cut_off();
  if (contents.chunk_count != chunk_count || messages_indexed != contents.message_count) {
    damaged(
        fmt::format("the index counts {} messages in {} chunks", messages_indexed, chunk_count));
  }
}

BagReader::BagReader(const std::filesystem::path& file) : impl_(std::make_unique<Impl>(file)) {}

BagReader::~BagReader() = default;

std::optional<RecordedMessage> BagReader::next() {
  Impl& r = *impl_;
  try {
    while (!r.at_end) {
      std::optional<RecordedMessage> message;
      if (!r.chunk.empty()) {
        const InnerRecord record = next_record(r.chunk);
        if (record.fields.op() != Op::kMessage && record.fields.op() != Op::kConnection) {
          r.damaged("a chunk holds a record that does not belong there");
        }
        message = r.take(record.fields, record.data);
      } else if (r.offset == r.file_size) {
        r.check_end();
        r.at_end = true;
      } else {
        const Fields fields = r.read_record();
        if (fields.op() == Op::kChunk) {
          r.open_chunk(fields);
        } else {
          message = r.take(fields, r.data);
        }
      }
      if (message) return message;
    }
  } catch (const std::out_of_range&) {
    r.damaged("a record is shorter than stated");
  }
  return std::nullopt;
}

RecordingInfo BagReader::info() const { return impl_->contents; }

bool is_bag(std::string_view beginning) { return beginning.starts_with("#ROSBAG V"); }

namespace {

/// Calls `visit` with each record from `offset` to the end of the file.
template <class Visit>
void read_index(std::ifstream& in, std::uint64_t offset, std::uint64_t file_size, Visit&& visit) {
  if (offset > file_size) throw std::out_of_range("the index lies beyond the file");
  std::vector<std::byte> bytes(file_size - offset);
  in.seekg(static_cast<std::streamoff>(offset));
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!in) throw std::out_of_range("the index cannot be read");
  for (ByteReader rest(bytes); !rest.empty();) visit(next_record(rest));
}

/// Empty when the bag has no index. Throws std::out_of_range when the index is damaged.
std::optional<RecordingInfo> info_from_index(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::vector<std::byte> start(bag::kMagic.size() + bag::kBagHeaderBytes);
  in.read(reinterpret_cast<char*>(start.data()), static_cast<std::streamsize>(start.size()));
  if (!in) return std::nullopt;
  ByteReader head(Bytes(start).subspan(bag::kMagic.size()));
  const Fields fields(head.take(head.get<std::uint32_t>()));
  const auto position = fields.number<std::uint64_t>("index_pos");
  if (position == 0) return std::nullopt;

  RecordingInfo info;
  std::map<std::uint32_t, std::size_t> connections;
  const auto visit = [&](const InnerRecord& record) {
    if (record.fields.op() == Op::kConnection) {
      connections[record.fields.number<std::uint32_t>("conn")] = info.topics.size();
      info.topics.push_back({record.fields.text("topic"),
                             ros::ros2_name(Fields(record.data).text("type")), "ros1", 0});
    } else if (record.fields.op() == Op::kChunkInfo) {
      const Time first = record.fields.time("start_time");
      info.start = info.chunk_count == 0 ? first : std::min(info.start, first);
      info.end = std::max(info.end, record.fields.time("end_time"));
      ++info.chunk_count;
      for (ByteReader counts(record.data); !counts.empty();) {
        const std::size_t topic = connections.at(counts.get<std::uint32_t>());
        const auto count = counts.get<std::uint32_t>();
        info.topics[topic].message_count += count;
        info.message_count += count;
      }
    }
  };
  read_index(in, position, std::filesystem::file_size(file), visit);
  if (info.chunk_count != fields.number<std::uint32_t>("chunk_count")) return std::nullopt;
  info.from_summary = true;
  return info;
}

RecordingInfo info_from_reading(const std::filesystem::path& file) {
  BagReader reader(file);
  std::string damage;
  try {
    while (reader.next()) {
    }
  } catch (const InputError& error) {
    damage = error.what();
  }
  RecordingInfo info = reader.info();
  info.damage = std::move(damage);
  return info;
}

}  // namespace

RecordingInfo read_bag_info(const std::filesystem::path& file) {
  const BagReader reader(file);  // throws if this is not a bag
  try {
    if (auto info = info_from_index(file)) return *std::move(info);
  } catch (const std::out_of_range&) {
    // The index is damaged: reading the whole bag finds out where.
  }
  return info_from_reading(file);
}

}  // namespace lidarena::dataset
