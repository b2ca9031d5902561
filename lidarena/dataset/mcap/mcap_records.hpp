// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "lidarena/dataset/byte_stream.hpp"

/// The records of an MCAP file, major version 0 (specification: mcap.dev/spec). A file is
///   magic, Header, data records, DataEnd, summary records, SummaryOffsets, Footer, magic
/// and every record is opcode (1 byte), length of the content (8 bytes), content; little endian.
namespace lidarena::dataset::mcap {

inline constexpr std::array<std::uint8_t, 8> kMagic{0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};
inline Bytes magic() { return std::as_bytes(std::span(kMagic)); }

enum class Opcode : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kAttachment = 0x09,
  kAttachmentIndex = 0x0A,
  kStatistics = 0x0B,
  kMetadata = 0x0C,
  kMetadataIndex = 0x0D,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F,
};
inline constexpr std::size_t kRecordHeadBytes = 9;  // opcode and length
inline constexpr std::size_t kFooterBytes = 20;     // content of a Footer

using StringMap = std::map<std::string, std::string>;

struct Header {
  std::string profile;
  std::string library;
};

struct Footer {
  std::uint64_t summary_start = 0;         ///< 0 = no summary
  std::uint64_t summary_offset_start = 0;  ///< 0 = no summary offsets
  std::uint32_t summary_crc = 0;           ///< 0 = not given
};

struct Schema {
  std::uint16_t id = 0;
  std::string name;      ///< e.g. sensor_msgs/msg/Imu
  std::string encoding;  ///< e.g. ros2msg
  std::string text;
};

struct Channel {
  std::uint16_t id = 0;
  std::uint16_t schema_id = 0;  ///< 0 = none
  std::string topic;
  std::string message_encoding;  ///< e.g. cdr
  StringMap metadata;
};

struct Message {
  std::uint16_t channel_id = 0;
  std::uint32_t sequence = 0;
  std::uint64_t log_time = 0;      ///< ns
  std::uint64_t publish_time = 0;  ///< ns
  Bytes data;                      ///< view into the decoded record
};

struct Chunk {
  std::uint64_t message_start_time = 0;  ///< ns
  std::uint64_t message_end_time = 0;    ///< ns
  std::uint64_t uncompressed_size = 0;
  std::uint32_t uncompressed_crc = 0;  ///< 0 = not given
  std::string compression;             ///< "", "zstd" or "lz4"
  Bytes records;                       ///< view into the decoded record
};

struct MessageIndex {
  std::uint16_t channel_id = 0;
  std::vector<std::pair<std::uint64_t, std::uint64_t>> entries;  ///< log time, offset in the chunk
};

struct ChunkIndex {
  std::uint64_t message_start_time = 0;  ///< ns
  std::uint64_t message_end_time = 0;    ///< ns
  std::uint64_t chunk_start = 0;         ///< offset of the Chunk record in the file
  std::uint64_t chunk_length = 0;        ///< of the whole record
  std::map<std::uint16_t, std::uint64_t> message_index_offsets;  ///< channel id, file offset
  std::uint64_t message_index_length = 0;
  std::string compression;
  std::uint64_t compressed_size = 0;
  std::uint64_t uncompressed_size = 0;
};

struct Statistics {
  std::uint64_t message_count = 0;
  std::uint16_t schema_count = 0;
  std::uint32_t channel_count = 0;
  std::uint32_t attachment_count = 0;
  std::uint32_t metadata_count = 0;
  std::uint32_t chunk_count = 0;
  std::uint64_t message_start_time = 0;  ///< ns
  std::uint64_t message_end_time = 0;    ///< ns
  std::map<std::uint16_t, std::uint64_t> channel_message_counts;
};

struct Metadata {
  std::string name;
  StringMap values;
};

struct MetadataIndex {
  std::uint64_t offset = 0;
  std::uint64_t length = 0;
  std::string name;
};

struct SummaryOffset {
  Opcode group = Opcode::kSchema;
  std::uint64_t group_start = 0;
  std::uint64_t group_length = 0;
};

/// Append a whole record, opcode and length included.
void append(ByteWriter& out, const Header& header);
void append(ByteWriter& out, const Footer& footer);
void append(ByteWriter& out, const Schema& schema);
void append(ByteWriter& out, const Channel& channel);
void append(ByteWriter& out, const Message& message);
void append(ByteWriter& out, const Chunk& chunk);
/// The same without the message's data, or without the chunk's records of `size` bytes: the caller
/// appends these.
void append_head(ByteWriter& out, const Message& message);
void append_head(ByteWriter& out, const Chunk& chunk, std::uint64_t size);
void append(ByteWriter& out, const MessageIndex& index);
void append(ByteWriter& out, const ChunkIndex& index);
void append(ByteWriter& out, const Statistics& statistics);
void append(ByteWriter& out, const Metadata& metadata);
void append(ByteWriter& out, const MetadataIndex& index);
void append(ByteWriter& out, const SummaryOffset& offset);
void append_data_end(ByteWriter& out, std::uint32_t data_crc);

/// Decode the content of a record; fields added by later versions at its end are ignored. All throw
/// std::out_of_range when the content is too short.
Header decode_header(Bytes content);
Footer decode_footer(Bytes content);
Schema decode_schema(Bytes content);
Channel decode_channel(Bytes content);
Message decode_message(Bytes content);
Chunk decode_chunk(Bytes content);
ChunkIndex decode_chunk_index(Bytes content);
Statistics decode_statistics(Bytes content);
Metadata decode_metadata(Bytes content);
MetadataIndex decode_metadata_index(Bytes content);

}  // namespace lidarena::dataset::mcap
