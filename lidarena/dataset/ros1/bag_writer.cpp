// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/ros1/bag_writer.hpp"

#include <algorithm>
#include <limits>
#include <set>
#include <vector>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/compression.hpp"
#include "lidarena/dataset/messages/ros_messages.hpp"
#include "lidarena/dataset/part_file.hpp"
#include "lidarena/dataset/ros1/bag_records.hpp"

namespace lidarena::dataset {

using bag::Op;

namespace {

constexpr std::uint32_t kIndexVersion = 1;

struct IndexEntry {
  Time time;
  std::uint32_t offset;  ///< of the message's record in the chunk
};

struct ChunkSummary {
  std::uint64_t position = 0;  ///< of the chunk's record in the file
  Time start{0};
  Time end{0};
  std::map<std::uint32_t, std::uint32_t> counts;  ///< number of messages by connection
};

}  // namespace

struct BagWriter::Impl {
  Impl(const std::filesystem::path& path, const BagWriterOptions& o)
      : file(path), place(path.string()), options(o) {
    file.write(bag::kMagic);
    file.write(bag_header(0).bytes());
    file.flush();
  }

  PartFile file;
  std::string place;
  BagWriterOptions options;
  RecordingInfo written;
  std::vector<ByteWriter> connections;  ///< their records, by id
  std::set<std::uint16_t> declared;     ///< connections already written
  std::vector<ChunkSummary> chunks;

  ByteWriter chunk;  ///< records of the chunk being built
  std::map<std::uint32_t, std::vector<IndexEntry>> chunk_index;
  Time chunk_start{0};
  Time chunk_end{0};
  std::vector<std::byte> compressed;

  /// An index position of 0 means that the bag was never closed.
  ByteWriter bag_header(std::uint64_t index_position) const {
    bag::Record header(Op::kBagHeader);
    header.number("index_pos", index_position)
        .number("conn_count", static_cast<std::uint32_t>(declared.size()))
        .number("chunk_count", static_cast<std::uint32_t>(chunks.size()));
    const std::string padding(bag::kBagHeaderBytes - header.header_size(), ' ');
    ByteWriter bytes;
    header.append_to(bytes, std::as_bytes(std::span(padding)));
    return bytes;
  }

  void append_index() {
    for (const auto& [connection, entries] : chunk_index) {
      ByteWriter data;
      for (const IndexEntry& entry : entries) {
        bag::put_time(entry.time, data);
        data.put(entry.offset);
      }
      ByteWriter record;
      bag::Record(Op::kIndex)
          .number("ver", kIndexVersion)
          .number("conn", connection)
          .number("count", static_cast<std::uint32_t>(entries.size()))
          .append_to(record, data.bytes());
      file.write(record.bytes());
      chunks.back().counts[connection] = static_cast<std::uint32_t>(entries.size());
    }
  }

  void close_chunk() {
    if (chunk_index.empty()) return;
    const bool is_lz4 = options.compression == BagCompression::kLz4;
    const Bytes records = is_lz4 ? compress_lz4(chunk.bytes(), compressed) : chunk.bytes();
    chunks.push_back({file.size(), chunk_start, chunk_end, {}});
    ByteWriter head;
    bag::Record(Op::kChunk)
        .text("compression", is_lz4 ? "lz4" : "none")
        .number("size", static_cast<std::uint32_t>(chunk.size()))
        .append_to(head, {});
    // The length that ends the header is that of the payload, which is written after it, uncopied.
    head.replace(head.size() - sizeof(std::uint32_t), static_cast<std::uint32_t>(records.size()));
    file.write(head.bytes());
    file.write(records);
    append_index();
    file.flush();
    ++written.chunk_count;
    chunk.clear();
    chunk_index.clear();
  }

  void write_summary() {
    for (const std::uint16_t id : declared) file.write(connections[id].bytes());
    for (const ChunkSummary& summary : chunks) {
      ByteWriter data;
      for (const auto& [connection, count] : summary.counts) {
        data.put(connection);
        data.put(count);
      }
      ByteWriter record;
      bag::Record(Op::kChunkInfo)
          .number("ver", kIndexVersion)
          .number("chunk_pos", summary.position)
          .time("start_time", summary.start)
          .time("end_time", summary.end)
          .number("count", static_cast<std::uint32_t>(summary.counts.size()))
          .append_to(record, data.bytes());
      file.write(record.bytes());
    }
  }
};

BagWriter::BagWriter(const std::filesystem::path& file, const BagWriterOptions& options)
    : impl_(std::make_unique<Impl>(file, options)) {}

BagWriter::~BagWriter() = default;

std::uint16_t BagWriter::add_topic(const std::string& name, std::string_view type, bool latched) {
  Impl& w = *impl_;
  const auto id = static_cast<std::uint16_t>(w.connections.size());
  bag::Record description = bag::Record::without_op();
  description.text("topic", name)
      .text("type", ros::ros1_name(type))
      .text("md5sum", ros::ros1_md5_of(type))
      .text("message_definition", ros::definition_of(type, Encoding::kRos1));
  if (latched) description.text("callerid", "/lidarena").text("latching", "1");
  bag::Record(Op::kConnection)
      .number("conn", std::uint32_t{id})
      .text("topic", name)
      .append_to(w.connections.emplace_back(), description.fields());
  w.written.topics.push_back({name, ros::ros2_name(type), "ros1", 0});
  return id;
}

void BagWriter::write(std::uint16_t topic, Time log_time, Time /*publish_time*/, Bytes message) {
  Impl& w = *impl_;
  constexpr std::chrono::seconds kLast{std::numeric_limits<std::uint32_t>::max()};
  if (log_time < Time{0} || log_time >= kLast) {
    throw InputError(w.place, "a message before the epoch (1970) or after 2106 cannot be stored",
                     "shift the times so that none is negative");
  }
  if (w.declared.insert(topic).second) w.chunk.put(w.connections[topic].bytes());
  const bool first_of_chunk = w.chunk_index.empty();
  w.chunk_start = first_of_chunk ? log_time : std::min(w.chunk_start, log_time);
  w.chunk_end = first_of_chunk ? log_time : std::max(w.chunk_end, log_time);
  w.chunk_index[topic].push_back({log_time, static_cast<std::uint32_t>(w.chunk.size())});
  bag::Record(Op::kMessage)
      .number("conn", std::uint32_t{topic})
      .time("time", log_time)
      .append_to(w.chunk, message);

  RecordingInfo& total = w.written;
  total.start = total.message_count == 0 ? log_time : std::min(total.start, log_time);
  total.end = std::max(total.end, log_time);
  ++total.message_count;
  ++total.topics[topic].message_count;
  if (w.chunk.size() >= w.options.chunk_bytes) w.close_chunk();
}

RecordingInfo BagWriter::info() const { return impl_->written; }

void BagWriter::close() {
  Impl& w = *impl_;
  w.close_chunk();
  const std::uint64_t index_position = w.file.size();
  w.write_summary();
  w.file.overwrite(bag::kMagic.size(), w.bag_header(index_position).bytes());
  w.file.commit();
}

}  // namespace lidarena::dataset
