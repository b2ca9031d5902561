// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/ros1/bag_records.hpp"

#include <stdexcept>

namespace lidarena::dataset::bag {
namespace {
std::string_view text_of(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}
}  // namespace

Fields::Fields(Bytes header) {
  for (ByteReader in(header); !in.empty();) {
    const Bytes field = in.take(in.get<std::uint32_t>());
    const std::size_t equals = text_of(field).find('=');
    if (equals == std::string_view::npos) throw std::out_of_range("a field has no name");
    values_[text_of(field).substr(0, equals)] = field.subspan(equals + 1);
  }
}

Bytes Fields::value(std::string_view name) const {
  const auto found = values_.find(name);
  if (found == values_.end()) throw std::out_of_range("a field is missing");
  return found->second;
}

std::string Fields::text(std::string_view name) const { return std::string(text_of(value(name))); }

Time Fields::time(std::string_view name) const {
  ByteReader in(value(name));
  return get_time(in);
}

Record& Record::field(std::string_view name, Bytes value) {
  header_.put(static_cast<std::uint32_t>(name.size() + 1 + value.size()));
  header_.put(std::as_bytes(std::span(name)));
  header_.put('=');
  header_.put(value);
  return *this;
}

Record& Record::time(std::string_view name, Time time) {
  ByteWriter value;
  put_time(time, value);
  return field(name, value.bytes());
}

void Record::append_to(ByteWriter& out, Bytes data) const {
  out.put(static_cast<std::uint32_t>(header_.size()));
  out.put(header_.bytes());
  out.put(static_cast<std::uint32_t>(data.size()));
  out.put(data);
}

void put_time(Time time, ByteWriter& out) {
  const auto seconds = std::chrono::floor<std::chrono::seconds>(time);
  out.put(static_cast<std::uint32_t>(seconds.count()));
  out.put(static_cast<std::uint32_t>((time - seconds).count()));
}

Time get_time(ByteReader& in) {
  const std::chrono::seconds seconds{in.get<std::uint32_t>()};
  return seconds + Time{in.get<std::uint32_t>()};
}

}  // namespace lidarena::dataset::bag
