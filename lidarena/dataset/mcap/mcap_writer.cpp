// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/mcap/mcap_writer.hpp"

#include <algorithm>
#include <optional>
#include <set>
#include <vector>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/compression.hpp"
#include "lidarena/dataset/part_file.hpp"

namespace lidarena::dataset {

struct McapWriter::Impl {
  Impl(const std::filesystem::path& path, const McapWriterOptions& o)
      : file(path), options(o), place(path.string()) {
    if (options.zstd_level != 0) compressor.emplace(options.zstd_level);
  }

  PartFile file;
  McapWriterOptions options;
  std::string place;
  std::optional<ZstdCompressor> compressor;
  std::uint32_t crc = 0;  ///< of the data section, then of the summary

  std::vector<mcap::Schema> schemas;    ///< id i + 1 at index i
  std::vector<mcap::Channel> channels;  ///< likewise
  std::set<std::uint16_t> schemas_written;
  std::set<std::uint16_t> channels_written;
  mcap::Statistics statistics;
  std::vector<mcap::ChunkIndex> chunk_indexes;
  std::vector<mcap::MetadataIndex> metadata_indexes;

  ByteWriter chunk;   ///< records of the chunk being built
  ByteWriter record;  ///< scratch
  std::map<std::uint16_t, mcap::MessageIndex> chunk_messages;
  std::uint64_t chunk_start_time = 0;
  std::uint64_t chunk_end_time = 0;

  void write(Bytes bytes) {
    crc = crc32_of(bytes, crc);
    file.write(bytes);
  }

  template <class Record>
  void write_record(const Record& content) {
    record.clear();
    append(record, content);
    write(record.bytes());
  }

  /// Appends a channel, preceded by its schema, if they are not in the file yet.
  void declare(std::uint16_t channel_id, ByteWriter& out) {
    if (!channels_written.insert(channel_id).second) return;
    const mcap::Channel& channel = channels[channel_id - 1U];
    const std::uint16_t schema = channel.schema_id;
    if (schema != 0 && schemas_written.insert(schema).second) append(out, schemas[schema - 1U]);
    append(out, channel);
  }

  /// Writes the chunk. `tail` is the end of its last record, passed separately to avoid a copy.
  void close_chunk(Bytes tail = {}) {
    if (chunk_messages.empty()) return;
    const std::uint64_t size = chunk.size() + tail.size();
    const std::uint32_t crc_of_records = crc32_of(tail, crc32_of(chunk.bytes()));
    Bytes records = chunk.bytes();
    std::uint64_t stored_size = size;
    if (compressor) {
      records = compressor->compress(records);
      stored_size = records.size();
    }
    const std::string compression = compressor ? "zstd" : "";
    mcap::ChunkIndex index{chunk_start_time, chunk_end_time, file.size(), 0, {}, 0,
                           compression,      stored_size,    size};
    record.clear();
    append_head(
        record,
        mcap::Chunk{chunk_start_time, chunk_end_time, size, crc_of_records, compression, {}},
        stored_size);
    write(record.bytes());
    write(records);
    write(tail);
    index.chunk_length = file.size() - index.chunk_start;
    for (const auto& [channel_id, messages] : chunk_messages) {
      index.message_index_offsets[channel_id] = file.size();
      write_record(messages);
    }
    index.message_index_length = file.size() - index.chunk_start - index.chunk_length;
    chunk_indexes.push_back(std::move(index));
    file.flush();
    ++statistics.chunk_count;
    chunk.clear();
    chunk_messages.clear();
  }

  /// Writes one group of the summary, records of one kind, and appends its position to `offsets`.
  template <class Records>
  void write_group(mcap::Opcode opcode, const Records& records,
                   std::vector<mcap::SummaryOffset>& offsets) {
    if (records.empty()) return;
    const std::uint64_t start = file.size();
    for (const auto& content : records) write_record(content);
    offsets.push_back({opcode, start, file.size() - start});
  }

  void write_summary();
};

McapWriter::McapWriter(const std::filesystem::path& file, const McapWriterOptions& options)
    : impl_(std::make_unique<Impl>(file, options)) {
  impl_->write(mcap::magic());
  impl_->write_record(mcap::Header{options.profile, "lidarena"});
}

McapWriter::~McapWriter() = default;

std::uint16_t McapWriter::add_schema(const std::string& name, const std::string& encoding,
                                     const std::string& text) {
  const auto id = static_cast<std::uint16_t>(impl_->schemas.size() + 1);
  impl_->schemas.push_back({id, name, encoding, text});
  impl_->statistics.schema_count = id;
  return id;
}

std::uint16_t McapWriter::add_channel(const std::string& topic, std::uint16_t schema_id,
                                      const std::string& message_encoding,
                                      const mcap::StringMap& metadata) {
  const auto id = static_cast<std::uint16_t>(impl_->channels.size() + 1);
  impl_->channels.push_back({id, schema_id, topic, message_encoding, metadata});
  impl_->statistics.channel_count = id;
  impl_->statistics.channel_message_counts[id] = 0;
  return id;
}

void McapWriter::add_metadata(const std::string& name, const mcap::StringMap& values) {
  impl_->close_chunk();
  const std::uint64_t start = impl_->file.size();
  impl_->write_record(mcap::Metadata{name, values});
  impl_->metadata_indexes.push_back({start, impl_->file.size() - start, name});
  ++impl_->statistics.metadata_count;
  impl_->file.flush();
}

void McapWriter::write(std::uint16_t channel_id, Time log_time, Time publish_time, Bytes data) {
  if (log_time < Time{0} || publish_time < Time{0}) {
    throw InputError(impl_->place, "a message before the epoch (negative time) cannot be stored",
                     "shift the times so that none is negative");
  }
  Impl& w = *impl_;
  const auto time = static_cast<std::uint64_t>(log_time.count());
  mcap::Statistics& total = w.statistics;
  w.declare(channel_id, w.chunk);

  w.chunk_start_time = w.chunk_messages.empty() ? time : std::min(w.chunk_start_time, time);
  w.chunk_end_time = w.chunk_messages.empty() ? time : std::max(w.chunk_end_time, time);
  total.message_start_time =
      total.message_count == 0 ? time : std::min(total.message_start_time, time);
  total.message_end_time = std::max(total.message_end_time, time);

  std::uint64_t& count = total.channel_message_counts.at(channel_id);
  mcap::MessageIndex& index = w.chunk_messages[channel_id];
  index.channel_id = channel_id;
  index.entries.emplace_back(time, w.chunk.size());
  append_head(w.chunk, mcap::Message{channel_id, static_cast<std::uint32_t>(count), time,
                                     static_cast<std::uint64_t>(publish_time.count()), data});
  ++count;
  ++total.message_count;
  if (!w.compressor && data.size() >= w.options.chunk_bytes) {
    w.close_chunk(data);
    return;
  }
  w.chunk.put(data);
  if (w.chunk.size() >= w.options.chunk_bytes) w.close_chunk();
}

const mcap::Statistics& McapWriter::statistics() const { return impl_->statistics; }

void McapWriter::Impl::write_summary() {
  crc = 0;
  mcap::Footer footer;
  footer.summary_start = file.size();
  std::vector<mcap::SummaryOffset> offsets;
  write_group(mcap::Opcode::kSchema, schemas, offsets);
  write_group(mcap::Opcode::kChannel, channels, offsets);
  write_group(mcap::Opcode::kStatistics, std::vector{statistics}, offsets);
  write_group(mcap::Opcode::kMetadataIndex, metadata_indexes, offsets);
  write_group(mcap::Opcode::kChunkIndex, chunk_indexes, offsets);
  footer.summary_offset_start = file.size();
  for (const mcap::SummaryOffset& offset : offsets) write_record(offset);
  // The CRC covers the footer up to the CRC itself.
  record.clear();
  append(record, footer);
  footer.summary_crc =
      crc32_of(record.bytes().first(record.size() - sizeof footer.summary_crc), crc);
  write_record(footer);
}

void McapWriter::close() {
  Impl& w = *impl_;
  w.close_chunk();
  w.record.clear();
  for (const mcap::Channel& silent : w.channels) w.declare(silent.id, w.record);
  w.write(w.record.bytes());
  w.record.clear();
  mcap::append_data_end(w.record, w.crc);
  w.write(w.record.bytes());
  w.write_summary();
  w.write(mcap::magic());
  w.file.commit();
}

}  // namespace lidarena::dataset
