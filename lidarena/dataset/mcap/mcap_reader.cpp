// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/mcap/mcap_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <stdexcept>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/compression.hpp"
#include "lidarena/dataset/damaged_file.hpp"

namespace lidarena::dataset {

using mcap::Opcode;

namespace {
bool may_be_in_chunk(Opcode opcode) {
  constexpr auto kFirstExtension = static_cast<Opcode>(0x80);  // of applications, skipped
  return (opcode >= Opcode::kSchema && opcode <= Opcode::kMessage) || opcode >= kFirstExtension;
}

bool may_be_in_summary(Opcode opcode) {
  return opcode != Opcode::kMessage && opcode != Opcode::kChunk &&
         opcode != Opcode::kMessageIndex && opcode != Opcode::kMetadata &&
         opcode != Opcode::kAttachment;
}
}  // namespace

struct McapReader::Impl {
  explicit Impl(const std::filesystem::path& file);

  std::string place;  ///< the file's name
  std::ifstream in;
  std::uint64_t file_size = 0;
  std::uint64_t offset = 0;         ///< of the next byte to read
  std::uint64_t record_offset = 0;  ///< of the top-level record being read
  std::uint32_t crc = 0;            ///< of the section up to the last record
  std::uint64_t summary_start = 0;  ///< end of the data section; 0 until it is reached
  bool at_end = false;

  std::vector<std::byte> record;    ///< content of the top-level record
  std::vector<std::byte> unpacked;  ///< of a compressed chunk
  ByteReader chunk{Bytes{}};        ///< unread rest of the current chunk

  mcap::Header header;
  std::map<std::uint16_t, mcap::Schema> schemas;
  std::map<std::uint16_t, mcap::Channel> channels;
  std::map<std::string, mcap::StringMap> metadata;
  mcap::Statistics counted;

  std::string at(std::uint64_t byte) const { return fmt::format("{}: byte {}", place, byte); }
  [[noreturn]] void cut_off();
  [[noreturn]] void damaged(std::string_view what) const;

  void read(std::span<std::byte> bytes);
  Opcode read_record();
  std::optional<McapMessage> take(Opcode opcode, Bytes content);
  void open_chunk(const mcap::Chunk& content);
  McapMessage message(const mcap::Message& content);
  void add_channel(mcap::Channel channel);
  void check_data_crc(std::uint32_t expected);
  void check_statistics(const mcap::Statistics& claimed) const;
  void finish(const mcap::Footer& footer);
};

McapReader::Impl::Impl(const std::filesystem::path& file)
    : place(file.string()), in(file, std::ios::binary) {
  std::error_code error;
  file_size = std::filesystem::file_size(file, error);
  if (!in || error) throw InputError(place, "cannot be opened", "check the path");
  if (file_size == 0) throw InputError(place, "is empty", "nothing was recorded; record it again");
  std::array<std::byte, mcap::kMagic.size()> start{};
  in.read(reinterpret_cast<char*>(start.data()), start.size());
  if (!std::ranges::equal(start, mcap::magic())) {
    throw InputError(
        place, "is not an MCAP file (version 0): it does not start with the magic bytes of MCAP",
        "give a .mcap file");
  }
  offset = start.size();
  crc = crc32_of(start);
}

/// Called when a record reaches beyond the end of the file. If the file ends with the magic bytes,
/// the length of the record is wrong; else the file is cut off.
void McapReader::Impl::cut_off() {
  std::array<std::byte, mcap::kMagic.size()> end{};
  in.seekg(-static_cast<std::streamoff>(end.size()), std::ios::end);
  in.read(reinterpret_cast<char*>(end.data()), end.size());
  const bool has_end = file_size > 2 * end.size() && std::ranges::equal(end, mcap::magic());
  if (has_end && offset < file_size)
    damaged("the length of a record reaches beyond the end of the file");
  throw DamagedFile(
      at(file_size), fmt::format("the file is cut off after {} messages", counted.message_count),
      "the messages before this byte are intact; the recording was stopped, copied in "
      "part, or the disk was full");
}

void McapReader::Impl::damaged(std::string_view what) const {
  throw DamagedFile(at(record_offset),
                    fmt::format("{} (after {} messages)", what, counted.message_count),
                    "the messages before this byte are intact; copy the file again");
}

void McapReader::Impl::read(std::span<std::byte> bytes) {
  if (bytes.size() > file_size - offset) cut_off();
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!in) throw InputError(at(offset), "cannot be read", "check the disk");
  offset += bytes.size();
}

/// Reads one top-level record into `record` and adds it to `crc`, unless it is a DataEnd or Footer:
/// these hold the checksum of what precedes them.
Opcode McapReader::Impl::read_record() {
  record_offset = offset;
  std::array<std::byte, mcap::kRecordHeadBytes> head{};
  read(head);
  ByteReader fields{Bytes(head)};
  const auto opcode = static_cast<Opcode>(fields.get<std::uint8_t>());
  const auto length = fields.get<std::uint64_t>();
  if (length > file_size - offset) cut_off();  // before anything is allocated
  record.resize(length);
  read(record);
  if (opcode != Opcode::kDataEnd && opcode != Opcode::kFooter) {
    crc = crc32_of(record, crc32_of(head, crc));
  }
  return opcode;
}

void McapReader::Impl::open_chunk(const mcap::Chunk& content) {
  Bytes records = content.records;
  if (!content.compression.empty()) {
    try {
      decompress(content.compression, content.records, content.uncompressed_size, unpacked);
    } catch (const std::runtime_error& error) {
      damaged(fmt::format("the chunk {}", error.what()));
    }
    records = unpacked;
  }
  if (records.size() != content.uncompressed_size)
    damaged("the chunk's size differs from the stated size");
  if (content.uncompressed_crc != 0 && crc32_of(records) != content.uncompressed_crc) {
    damaged("the chunk's checksum (CRC) is wrong");
  }
  chunk = ByteReader(records);
  ++counted.chunk_count;
}

McapMessage McapReader::Impl::message(const mcap::Message& content) {
  const auto channel = channels.find(content.channel_id);
  if (channel == channels.end()) damaged("a message belongs to a channel that was never declared");
  constexpr auto kLatest = static_cast<std::uint64_t>(Time::max().count());
  if (content.log_time > kLatest || content.publish_time > kLatest) damaged("a time is too large");
  const std::uint64_t time = content.log_time;
  const bool first = counted.message_count == 0;
  counted.message_start_time = first ? time : std::min(counted.message_start_time, time);
  counted.message_end_time = std::max(counted.message_end_time, time);
  ++counted.message_count;
  ++counted.channel_message_counts[content.channel_id];
  const auto as_time = [](std::uint64_t ns) { return Time{static_cast<std::int64_t>(ns)}; };
  return {&channel->second, content.sequence, as_time(time), as_time(content.publish_time),
          content.data};
}

void McapReader::Impl::add_channel(mcap::Channel channel) {
  const auto [place_of, added] = channels.try_emplace(channel.id, channel);
  if (!added && place_of->second.topic != channel.topic) {
    damaged(fmt::format("channel {} is declared for both {} and {}", channel.id,
                        place_of->second.topic, channel.topic));
  }
}

void McapReader::Impl::check_data_crc(std::uint32_t expected) {
  if (expected != 0 && expected != crc) damaged("the data section's checksum (CRC) is wrong");
  summary_start = offset;
  crc = 0;
}

void McapReader::Impl::check_statistics(const mcap::Statistics& claimed) const {
  if (claimed.message_count != counted.message_count) {
    damaged(fmt::format("the summary counts {} messages", claimed.message_count));
  }
}

void McapReader::Impl::finish(const mcap::Footer& footer) {
  if (footer.summary_start != 0 && footer.summary_crc != 0) {
    if (footer.summary_start != summary_start)
      damaged("the summary does not start where the footer says");
    ByteWriter covered;  // the checksum covers the footer up to the checksum itself
    append(covered, footer);
    const Bytes head = covered.bytes().first(covered.size() - sizeof footer.summary_crc);
    if (crc32_of(head, crc) != footer.summary_crc) damaged("the summary's checksum (CRC) is wrong");
  }
  std::array<std::byte, mcap::kMagic.size()> end{};
  read(end);
  if (!std::ranges::equal(end, mcap::magic())) damaged("the magic bytes at the end are wrong");
  at_end = true;
}

/// Handles one record of the file or of a chunk; returns the message if it is one.
std::optional<McapMessage> McapReader::Impl::take(Opcode opcode, Bytes content) {
  switch (opcode) {
    case Opcode::kHeader:
      header = mcap::decode_header(content);
      break;
    case Opcode::kSchema: {
      mcap::Schema schema = mcap::decode_schema(content);
      schemas.try_emplace(schema.id, std::move(schema));
      break;
    }
    case Opcode::kChannel:
      add_channel(mcap::decode_channel(content));
      break;
    case Opcode::kMessage:
      return message(mcap::decode_message(content));
    case Opcode::kChunk:
      open_chunk(mcap::decode_chunk(content));
      break;
    case Opcode::kMetadata: {
      mcap::Metadata entry = mcap::decode_metadata(content);
      metadata[entry.name] = std::move(entry.values);
      ++counted.metadata_count;
      break;
    }
    case Opcode::kAttachment:
      ++counted.attachment_count;
      break;
    case Opcode::kDataEnd:
      check_data_crc(ByteReader(content).get<std::uint32_t>());
      break;
    case Opcode::kStatistics:
      check_statistics(mcap::decode_statistics(content));
      break;
    case Opcode::kFooter:
      finish(mcap::decode_footer(content));
      break;
    default:
      break;  // indexes, not needed to read in order, and records of later versions
  }
  return std::nullopt;
}

McapReader::McapReader(const std::filesystem::path& file) : impl_(std::make_unique<Impl>(file)) {
  try {
    if (impl_->read_record() != Opcode::kHeader) impl_->damaged("the first record is not a Header");
    impl_->take(Opcode::kHeader, impl_->record);
  } catch (const std::out_of_range&) {
    impl_->damaged("the Header is too short");
  }
}

McapReader::~McapReader() = default;

std::optional<McapMessage> McapReader::next() {
  Impl& r = *impl_;
  try {
    while (!r.at_end) {
      std::optional<McapMessage> message;
      if (!r.chunk.empty()) {
        const auto opcode = static_cast<Opcode>(r.chunk.get<std::uint8_t>());
        const Bytes content = r.chunk.take(r.chunk.get<std::uint64_t>());
        if (!may_be_in_chunk(opcode))
          r.damaged("a chunk holds a record that does not belong there");
        message = r.take(opcode, content);
      } else {
        const Opcode opcode = r.read_record();
        if (r.summary_start != 0 && !may_be_in_summary(opcode)) {
          r.damaged("the summary holds a record that does not belong there");
        }
        message = r.take(opcode, r.record);
      }
      if (message) return message;
    }
  } catch (const std::out_of_range&) {
    r.damaged("a record is shorter than stated");
  }
  return std::nullopt;
}

const mcap::Header& McapReader::header() const { return impl_->header; }
const std::map<std::uint16_t, mcap::Channel>& McapReader::channels() const {
  return impl_->channels;
}
const std::map<std::uint16_t, mcap::Schema>& McapReader::schemas() const { return impl_->schemas; }
const std::map<std::string, mcap::StringMap>& McapReader::metadata() const {
  return impl_->metadata;
}
const mcap::Statistics& McapReader::statistics() const { return impl_->counted; }

}  // namespace lidarena::dataset
