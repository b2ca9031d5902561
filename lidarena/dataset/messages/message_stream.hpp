// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "lidarena/dataset/byte_stream.hpp"

/// Serialization of ROS messages: their members in order, little endian.
namespace lidarena::dataset {

enum class Encoding {
  /// Plain CDR, version 1 (OMG CORBA 3.0 chapter 15.3; DDS-XTypes 1.3, 7.4.1), as ROS 2 writes it:
  /// four bytes of encapsulation header; a number of N bytes starts at a multiple of N, counted
  /// from the end of the header; a string's length includes its terminating zero.
  kCdr,
  /// ROS 1: without header, padding and terminating zeros.
  kRos1,
};

/// Serializes one message after another into the same buffer.
class MessageWriter {
 public:
  explicit MessageWriter(Encoding encoding = Encoding::kCdr) : encoding_(encoding) { clear(); }
  Encoding encoding() const { return encoding_; }
  /// Starts the next message.
  void clear();

  template <class T>
  requires std::is_arithmetic_v<T>
  void put(T value) {
    static_assert(!std::is_same_v<T, long double>);
    align(sizeof value);
    append(std::as_bytes(std::span(&value, 1)));
  }
  void put(std::string_view text);
  /// Appends a sequence of bytes: its length, then `size` zeros. Returns a span of these, for the
  /// caller to fill in.
  std::span<std::byte> put_octets(std::size_t size);
  /// Appends the same number `count` times, as an array of fixed size (without a length).
  void put_repeated(double value, std::size_t count);

  Bytes bytes() const { return bytes_; }

 private:
  void align(std::size_t size);
  void append(Bytes bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }

  Encoding encoding_;
  std::vector<std::byte> bytes_;
};

/// Reads one message. Throws InputError (place `place`) when the message has another encoding or is
/// shorter than its type.
class MessageReader {
 public:
  MessageReader(Bytes message, std::string_view place, Encoding encoding = Encoding::kCdr);
  Encoding encoding() const { return encoding_; }

  template <class T>
  requires std::is_arithmetic_v<T> T get() {
    align(sizeof(T));
    T value;
    std::memcpy(&value, take(sizeof value).data(), sizeof value);
    return value;
  }
  std::string get_string();
  Bytes get_octets();
  /// An array of bytes of fixed size (without a length).
  Bytes get_bytes(std::size_t size) { return take(size); }
  /// Length of a sequence; each of its elements takes at least `element_bytes`, so that a damaged
  /// length is detected before memory is allocated.
  std::uint32_t get_length(std::size_t element_bytes);
  void skip_doubles(std::size_t count);

 private:
  void align(std::size_t size);
  Bytes take(std::size_t size);

  Encoding encoding_;
  Bytes message_;  ///< without the header
  std::size_t offset_ = 0;
  std::string place_;
};

}  // namespace lidarena::dataset
