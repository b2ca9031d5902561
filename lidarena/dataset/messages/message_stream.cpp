// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/messages/message_stream.hpp"

#include <array>

#include "lidarena/base/error.hpp"

namespace lidarena::dataset {
namespace {
constexpr std::array<std::byte, 4> kLittleEndianCdr{std::byte{0}, std::byte{1}};  // then options, 0

std::size_t aligned(std::size_t offset, std::size_t size) {
  return (offset + size - 1) / size * size;
}
}  // namespace

void MessageWriter::clear() {
  bytes_.clear();
  if (encoding_ == Encoding::kCdr) append(kLittleEndianCdr);
}

void MessageWriter::align(std::size_t size) {
  if (encoding_ != Encoding::kCdr) return;
  const std::size_t header = kLittleEndianCdr.size();
  bytes_.resize(header + aligned(bytes_.size() - header, size));
}

void MessageWriter::put(std::string_view text) {
  const bool closed = encoding_ == Encoding::kCdr;
  put(static_cast<std::uint32_t>(text.size() + (closed ? 1 : 0)));
  append(std::as_bytes(std::span(text)));
  if (closed) bytes_.push_back(std::byte{0});
}

std::span<std::byte> MessageWriter::put_octets(std::size_t size) {
  put(static_cast<std::uint32_t>(size));
  bytes_.resize(bytes_.size() + size);
  return std::span(bytes_).last(size);
}

void MessageWriter::put_repeated(double value, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) put(value);
}

MessageReader::MessageReader(Bytes message, std::string_view place, Encoding encoding)
    : encoding_(encoding), message_(message), place_(place) {
  if (encoding_ != Encoding::kCdr) return;
  const std::size_t header = kLittleEndianCdr.size();
  if (message.size() < header) throw InputError(place_, "a message is empty");
  // The two option bytes may state the padding at the end, which the reader does not need.
  if (message[0] != kLittleEndianCdr[0] || message[1] != kLittleEndianCdr[1]) {
    throw InputError(place_, "a message is not in little-endian plain CDR",
                     "record on a little-endian machine with CDR version 1");
  }
  message_ = message.subspan(header);
}

void MessageReader::align(std::size_t size) {
  if (encoding_ == Encoding::kCdr) offset_ = aligned(offset_, size);
}

Bytes MessageReader::take(std::size_t size) {
  if (offset_ > message_.size() || size > message_.size() - offset_) {
    throw InputError(place_, "a message is shorter than its type requires",
                     "the schema does not match the messages");
  }
  const Bytes taken = message_.subspan(offset_, size);
  offset_ += size;
  return taken;
}

std::string MessageReader::get_string() {
  const auto length = get<std::uint32_t>();
  if (length == 0) return {};  // some writers omit the terminating zero of an empty string
  const Bytes text = take(length);
  const std::size_t closing = encoding_ == Encoding::kCdr ? 1 : 0;
  return {reinterpret_cast<const char*>(text.data()), length - closing};
}

Bytes MessageReader::get_octets() {
  const auto length = get<std::uint32_t>();
  return take(length);
}

std::uint32_t MessageReader::get_length(std::size_t element_bytes) {
  const auto length = get<std::uint32_t>();
  if (std::uint64_t{length} * element_bytes > message_.size() - offset_) {
    throw InputError(place_, "a message states more elements than it can hold",
                     "the schema does not match the messages");
  }
  return length;
}

void MessageReader::skip_doubles(std::size_t count) {
  align(sizeof(double));
  take(count * sizeof(double));
}

}  // namespace lidarena::dataset
