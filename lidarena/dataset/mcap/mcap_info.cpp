// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/mcap/mcap_info.hpp"

#include <algorithm>
#include <fstream>
#include <optional>
#include <stdexcept>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/compression.hpp"
#include "lidarena/dataset/mcap/mcap_reader.hpp"
#include "lidarena/dataset/messages/ros_messages.hpp"

namespace lidarena::dataset {
namespace {

using mcap::Opcode;

/// This class and the functions below throw std::out_of_range when the file lacks the expected
/// content; the caller then reads the whole file instead.
class SummaryFile {
 public:
  explicit SummaryFile(const std::filesystem::path& file)
      : in_(file, std::ios::binary), size_(std::filesystem::file_size(file)) {}

  std::uint64_t size() const { return size_; }

  std::vector<std::byte> read(std::uint64_t offset, std::uint64_t length) {
    if (offset > size_ || length > size_ - offset) throw std::out_of_range("beyond the file");
    std::vector<std::byte> bytes(length);
    in_.seekg(static_cast<std::streamoff>(offset));
    in_.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(length));
    if (!in_) throw std::out_of_range("cannot be read");
    return bytes;
  }

 private:
  std::ifstream in_;
  std::uint64_t size_;
};

struct Record {
  Opcode opcode;
  Bytes content;
};

Record next_record(ByteReader& in) {
  const auto opcode = static_cast<Opcode>(in.get<std::uint8_t>());
  return {opcode, in.take(in.get<std::uint64_t>())};
}

/// The bytes from the start of the summary to the footer's checksum, verified; empty if the file
/// has no summary.
std::vector<std::byte> read_summary(SummaryFile& file) {
  constexpr std::uint64_t kEnd = mcap::kRecordHeadBytes + mcap::kFooterBytes + mcap::kMagic.size();
  if (file.size() < kEnd) return {};
  const std::vector<std::byte> end = file.read(file.size() - kEnd, kEnd);
  if (!std::ranges::equal(Bytes(end).last(mcap::kMagic.size()), mcap::magic())) return {};
  ByteReader in(end);
  const Record record = next_record(in);
  if (record.opcode != Opcode::kFooter) return {};
  const mcap::Footer footer = mcap::decode_footer(record.content);
  const std::uint64_t summary_end = file.size() - mcap::kMagic.size() - sizeof footer.summary_crc;
  if (footer.summary_start == 0 || footer.summary_start > summary_end) return {};
  std::vector<std::byte> summary =
      file.read(footer.summary_start, summary_end - footer.summary_start);
  if (footer.summary_crc != 0 && crc32_of(summary) != footer.summary_crc) return {};
  return summary;
}

template <class Channels, class Schemas>
void fill_topics(const Channels& channels, const Schemas& schemas,
                 const mcap::Statistics& statistics, McapInfo& info) {
  for (const auto& [id, channel] : channels) {
    const auto schema = schemas.find(channel.schema_id);
    const auto count = statistics.channel_message_counts.find(id);
    info.topics.push_back({channel.topic,
                           schema == schemas.end() ? "" : ros::ros2_name(schema->second.name),
                           channel.message_encoding,
                           count == statistics.channel_message_counts.end() ? 0 : count->second});
  }
  info.message_count = statistics.message_count;
  info.chunk_count = statistics.chunk_count;
  info.start = Time{static_cast<std::int64_t>(statistics.message_start_time)};
  info.end = Time{static_cast<std::int64_t>(statistics.message_end_time)};
}

std::optional<McapInfo> info_from_summary(const std::filesystem::path& path) {
  SummaryFile file(path);
  const std::vector<std::byte> summary = read_summary(file);
  McapInfo info;
  std::map<std::uint16_t, mcap::Channel> channels;
  std::map<std::uint16_t, mcap::Schema> schemas;
  std::optional<mcap::Statistics> statistics;
  for (ByteReader in(summary); !in.empty();) {
    if (static_cast<Opcode>(in.rest().front()) == Opcode::kFooter) break;
    const Record record = next_record(in);
    if (record.opcode == Opcode::kSchema) {
      mcap::Schema schema = mcap::decode_schema(record.content);
      schemas[schema.id] = std::move(schema);
    } else if (record.opcode == Opcode::kChannel) {
      mcap::Channel channel = mcap::decode_channel(record.content);
      channels[channel.id] = std::move(channel);
    } else if (record.opcode == Opcode::kStatistics) {
      statistics = mcap::decode_statistics(record.content);
    } else if (record.opcode == Opcode::kMetadataIndex) {
      const mcap::MetadataIndex index = mcap::decode_metadata_index(record.content);
      const std::vector<std::byte> bytes = file.read(index.offset, index.length);
      ByteReader at(bytes);
      info.metadata[index.name] = mcap::decode_metadata(next_record(at).content).values;
    }
  }
  // A summary without message counts is not enough.
  if (!statistics ||
      (statistics->message_count > 0 && statistics->channel_message_counts.empty())) {
    return std::nullopt;
  }
  fill_topics(channels, schemas, *statistics, info);
  info.from_summary = true;
  return info;
}

McapInfo info_from_reading(const std::filesystem::path& path) {
  McapReader reader(path);
  McapInfo info;
  try {
    while (reader.next()) {
    }
  } catch (const InputError& error) {
    info.damage = error.what();
  }
  info.metadata = reader.metadata();
  fill_topics(reader.channels(), reader.schemas(), reader.statistics(), info);
  return info;
}

}  // namespace

McapInfo read_mcap_info(const std::filesystem::path& file) {
  const McapReader reader(file);  // throws if this is not an MCAP file
  std::optional<McapInfo> info;
  try {
    info = info_from_summary(file);
  } catch (const std::out_of_range&) {
    // The summary is damaged: reading the whole file finds out where.
  }
  if (!info) info = info_from_reading(file);
  info->header = reader.header();
  return *std::move(info);
}

}  // namespace lidarena::dataset
