// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/mcap/mcap_records.hpp"

namespace lidarena::dataset::mcap {
namespace {

/// Writes opcode, length and what `content` writes. The length, filled in at the end, includes
/// `to_follow` bytes that the caller appends.
template <class Content>
void append_record_head(ByteWriter& out, Opcode opcode, std::uint64_t to_follow,
                        const Content& content) {
  out.put(static_cast<std::uint8_t>(opcode));
  const std::size_t length_at = out.size();
  out.put(std::uint64_t{0});
  content();
  out.replace(length_at, std::uint64_t{out.size() - length_at - sizeof(std::uint64_t)} + to_follow);
}

template <class Content>
void append_record(ByteWriter& out, Opcode opcode, const Content& content) {
  append_record_head(out, opcode, 0, content);
}

/// A map or an array: uint32 length in bytes, then the elements.
template <class Elements, class PutElement>
void append_list(ByteWriter& out, const Elements& elements, const PutElement& put_element) {
  const std::size_t length_at = out.size();
  out.put(std::uint32_t{0});
  for (const auto& element : elements) put_element(element);
  out.replace(length_at,
              static_cast<std::uint32_t>(out.size() - length_at - sizeof(std::uint32_t)));
}

template <class Map>
void append_map(ByteWriter& out, const Map& map) {
  append_list(out, map, [&](const auto& entry) {
    out.put(entry.first);
    out.put(entry.second);
  });
}

StringMap get_string_map(ByteReader& in) {
  ByteReader entries(in.take(in.get<std::uint32_t>()));
  StringMap map;
  while (!entries.empty()) {
    std::string key = entries.get_string();
    map[std::move(key)] = entries.get_string();
  }
  return map;
}

std::map<std::uint16_t, std::uint64_t> get_id_map(ByteReader& in) {
  ByteReader entries(in.take(in.get<std::uint32_t>()));
  std::map<std::uint16_t, std::uint64_t> map;
  while (!entries.empty()) {
    const auto key = entries.get<std::uint16_t>();
    map[key] = entries.get<std::uint64_t>();
  }
  return map;
}

}  // namespace

void append(ByteWriter& out, const Header& header) {
  append_record(out, Opcode::kHeader, [&] {
    out.put(header.profile);
    out.put(header.library);
  });
}

void append(ByteWriter& out, const Footer& footer) {
  append_record(out, Opcode::kFooter, [&] {
    out.put(footer.summary_start);
    out.put(footer.summary_offset_start);
    out.put(footer.summary_crc);
  });
}

void append(ByteWriter& out, const Schema& schema) {
  append_record(out, Opcode::kSchema, [&] {
    out.put(schema.id);
    out.put(schema.name);
    out.put(schema.encoding);
    out.put(schema.text);
  });
}

void append(ByteWriter& out, const Channel& channel) {
  append_record(out, Opcode::kChannel, [&] {
    out.put(channel.id);
    out.put(channel.schema_id);
    out.put(channel.topic);
    out.put(channel.message_encoding);
    append_map(out, channel.metadata);
  });
}

void append_head(ByteWriter& out, const Message& message) {
  append_record_head(out, Opcode::kMessage, message.data.size(), [&] {
    out.put(message.channel_id);
    out.put(message.sequence);
    out.put(message.log_time);
    out.put(message.publish_time);
  });
}

void append(ByteWriter& out, const Message& message) {
  append_head(out, message);
  out.put(message.data);
}

void append(ByteWriter& out, const Chunk& chunk) {
  append_head(out, chunk, chunk.records.size());
  out.put(chunk.records);
}

void append_head(ByteWriter& out, const Chunk& chunk, std::uint64_t size) {
  append_record_head(out, Opcode::kChunk, size, [&] {
    out.put(chunk.message_start_time);
    out.put(chunk.message_end_time);
    out.put(chunk.uncompressed_size);
    out.put(chunk.uncompressed_crc);
    out.put(chunk.compression);
    out.put(size);
  });
}

void append(ByteWriter& out, const MessageIndex& index) {
  append_record(out, Opcode::kMessageIndex, [&] {
    out.put(index.channel_id);
    append_map(out, index.entries);
  });
}

void append(ByteWriter& out, const ChunkIndex& index) {
  append_record(out, Opcode::kChunkIndex, [&] {
    out.put(index.message_start_time);
    out.put(index.message_end_time);
    out.put(index.chunk_start);
    out.put(index.chunk_length);
    append_map(out, index.message_index_offsets);
    out.put(index.message_index_length);
    out.put(index.compression);
    out.put(index.compressed_size);
    out.put(index.uncompressed_size);
  });
}

void append(ByteWriter& out, const Statistics& statistics) {
  append_record(out, Opcode::kStatistics, [&] {
    out.put(statistics.message_count);
    out.put(statistics.schema_count);
    out.put(statistics.channel_count);
    out.put(statistics.attachment_count);
    out.put(statistics.metadata_count);
    out.put(statistics.chunk_count);
    out.put(statistics.message_start_time);
    out.put(statistics.message_end_time);
    append_map(out, statistics.channel_message_counts);
  });
}

void append(ByteWriter& out, const Metadata& metadata) {
  append_record(out, Opcode::kMetadata, [&] {
    out.put(metadata.name);
    append_map(out, metadata.values);
  });
}

void append(ByteWriter& out, const MetadataIndex& index) {
  append_record(out, Opcode::kMetadataIndex, [&] {
    out.put(index.offset);
    out.put(index.length);
    out.put(index.name);
  });
}

void append(ByteWriter& out, const SummaryOffset& offset) {
  append_record(out, Opcode::kSummaryOffset, [&] {
    out.put(static_cast<std::uint8_t>(offset.group));
    out.put(offset.group_start);
    out.put(offset.group_length);
  });
}

void append_data_end(ByteWriter& out, std::uint32_t data_crc) {
  append_record(out, Opcode::kDataEnd, [&] { out.put(data_crc); });
}

// Members of a braced list are evaluated in order, so they are read in the order of the record.

Header decode_header(Bytes content) {
  ByteReader in(content);
  return {in.get_string(), in.get_string()};
}

Footer decode_footer(Bytes content) {
  ByteReader in(content);
  return {in.get<std::uint64_t>(), in.get<std::uint64_t>(), in.get<std::uint32_t>()};
}

Schema decode_schema(Bytes content) {
  ByteReader in(content);
  return {in.get<std::uint16_t>(), in.get_string(), in.get_string(), in.get_string()};
}

Channel decode_channel(Bytes content) {
  ByteReader in(content);
  return {in.get<std::uint16_t>(), in.get<std::uint16_t>(), in.get_string(), in.get_string(),
          get_string_map(in)};
}

Message decode_message(Bytes content) {
  ByteReader in(content);
  Message message{in.get<std::uint16_t>(),
                  in.get<std::uint32_t>(),
                  in.get<std::uint64_t>(),
                  in.get<std::uint64_t>(),
                  {}};
  message.data = in.rest();
  return message;
}

Chunk decode_chunk(Bytes content) {
  ByteReader in(content);
  Chunk chunk{in.get<std::uint64_t>(), in.get<std::uint64_t>(), in.get<std::uint64_t>(),
              in.get<std::uint32_t>(), in.get_string(),         {}};
  chunk.records = in.take(in.get<std::uint64_t>());
  return chunk;
}

ChunkIndex decode_chunk_index(Bytes content) {
  ByteReader in(content);
  return {in.get<std::uint64_t>(), in.get<std::uint64_t>(), in.get<std::uint64_t>(),
          in.get<std::uint64_t>(), get_id_map(in),          in.get<std::uint64_t>(),
          in.get_string(),         in.get<std::uint64_t>(), in.get<std::uint64_t>()};
}

Statistics decode_statistics(Bytes content) {
  ByteReader in(content);
  return {in.get<std::uint64_t>(), in.get<std::uint16_t>(), in.get<std::uint32_t>(),
          in.get<std::uint32_t>(), in.get<std::uint32_t>(), in.get<std::uint32_t>(),
          in.get<std::uint64_t>(), in.get<std::uint64_t>(), get_id_map(in)};
}

Metadata decode_metadata(Bytes content) {
  ByteReader in(content);
  return {in.get_string(), get_string_map(in)};
}

MetadataIndex decode_metadata_index(Bytes content) {
  ByteReader in(content);
  return {in.get<std::uint64_t>(), in.get<std::uint64_t>(), in.get_string()};
}

}  // namespace lidarena::dataset::mcap
