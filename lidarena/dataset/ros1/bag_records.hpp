// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "lidarena/base/time.hpp"
#include "lidarena/dataset/byte_stream.hpp"

/// Records of ROS 1 bags, version 2.0 (wiki.ros.org/Bags/Format/2.0). A record is a header of
/// NAME=VALUE fields and data, each preceded by its length (uint32).
namespace lidarena::dataset::bag {

inline constexpr std::string_view kMagic = "#ROSBAG V2.0\n";
/// Header and padding of the first record together: fixed, so that the record can be overwritten in
/// place when the bag is closed.
inline constexpr std::size_t kBagHeaderBytes = 4096;

enum class Op : std::uint8_t {
  kMessage = 2,
  kBagHeader = 3,
  kIndex = 4,
  kChunk = 5,
  kChunkInfo = 6,
  kConnection = 7,
};

/// The fields of a record header, with values as stored in the file.
class Fields {
 public:
  /// Throws std::out_of_range when the bytes are not a header.
  explicit Fields(Bytes header);
  Op op() const { return static_cast<Op>(number<std::uint8_t>("op")); }
  bool has(std::string_view name) const { return values_.contains(name); }
  /// These throw std::out_of_range when the field is missing or too short.
  std::string text(std::string_view name) const;
  template <class T>
  T number(std::string_view name) const {
    return ByteReader(value(name)).get<T>();
  }
  Time time(std::string_view name) const;

 private:
  Bytes value(std::string_view name) const;
  std::map<std::string_view, Bytes> values_;
};

/// Builds a record: add the fields, then call append_to() with the data.
class Record {
 public:
  explicit Record(Op op) { number("op", static_cast<std::uint8_t>(op)); }
  template <class T>
  Record& number(std::string_view name, T value) {
    return field(name, std::as_bytes(std::span(&value, 1)));
  }
  Record& text(std::string_view name, std::string_view value) {
    return field(name, std::as_bytes(std::span(value)));
  }
  Record& time(std::string_view name, Time time);
  std::size_t header_size() const { return header_.size(); }
  /// Appends the whole record.
  void append_to(ByteWriter& out, Bytes data) const;
  /// The serialized fields only, as needed for the data of a connection record.
  Bytes fields() const { return header_.bytes(); }
  /// Fields without an op, for such data.
  static Record without_op() { return Record(); }

 private:
  Record() = default;
  Record& field(std::string_view name, Bytes value);
  ByteWriter header_;
};

/// Seconds and nanoseconds, uint32 each.
void put_time(Time time, ByteWriter& out);
Time get_time(ByteReader& in);

}  // namespace lidarena::dataset::bag
