// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/packets/pcap_reader.hpp"

#include <fmt/format.h>

#include <array>
#include <bit>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/damaged_file.hpp"

namespace lidarena::dataset {
namespace {

constexpr std::size_t kFileHeader = 24;
constexpr std::size_t kPacketHeader = 16;
constexpr std::uint32_t kMicroseconds = 0xA1B2C3D4;
constexpr std::uint32_t kNanoseconds = 0xA1B23C4D;
constexpr std::uint32_t kMaxPacket = 1 << 20;  // bytes; no link carries longer ones
// Blocks of pcapng.
constexpr std::uint32_t kSection = 0x0A0D0D0A;
constexpr std::uint32_t kInterface = 1, kObsoletePacket = 2, kSimplePacket = 3, kEnhancedPacket = 6;
constexpr std::uint32_t kByteOrder = 0x1A2B3C4D;
constexpr std::uint16_t kTimeResolution = 9, kTimeOffset = 14;  // options of an interface

std::uint32_t little(const std::byte* at) {
  std::uint32_t value = 0;
  std::memcpy(&value, at, sizeof value);
  return value;
}

std::uint32_t swapped(std::uint32_t value) {
  return (value >> 24) | ((value >> 8) & 0xFF00) | ((value << 8) & 0xFF0000) | (value << 24);
}

/// Ticks of 10^-n s, or of 2^-n s with the upper bit of `resolution`.
Time time_of(std::uint64_t ticks, std::uint8_t resolution) {
  const unsigned power = resolution & 0x7FU;
  if ((resolution & 0x80U) != 0) {
    const unsigned bits = std::min(power, 34U);  // 2^34 ticks a second: 0.06 ns
    ticks >>= power - bits;
    const std::uint64_t part = ticks & ((std::uint64_t{1} << bits) - 1);
    return std::chrono::seconds(ticks >> bits) +
           Time{static_cast<std::int64_t>(part * 1'000'000'000 >> bits)};
  }
  for (unsigned i = power; i < 9; ++i) ticks *= 10;
  for (unsigned i = 9; i < power; ++i) ticks /= 10;
  return Time{static_cast<std::int64_t>(ticks)};
}

/// A number of the network's byte order.
std::uint16_t big16(Bytes bytes, std::size_t at) {
  return static_cast<std::uint16_t>(std::to_integer<unsigned>(bytes[at]) << 8 |
                                    std::to_integer<unsigned>(bytes[at + 1]));
}
std::uint32_t big32(Bytes bytes, std::size_t at) {
  return std::uint32_t{big16(bytes, at)} << 16 | big16(bytes, at + 2);
}

}  // namespace

PcapReader::PcapReader(const std::filesystem::path& file)
    : place_(file.string()), in_(file, std::ios::binary) {
  std::error_code error;
  file_size_ = std::filesystem::file_size(file, error);
  if (!in_ || error) throw InputError(place_, "cannot be opened", "check the path");
  std::array<std::byte, kFileHeader> header{};
  in_.read(reinterpret_cast<char*>(header.data()), header.size());
  const std::uint32_t magic = little(header.data());
  is_pcapng_ = magic == kSection;
  if (is_pcapng_) {
    in_.clear();
    in_.seekg(0);
    return;
  }
  swapped_ = swapped(magic) == kMicroseconds || swapped(magic) == kNanoseconds;
  const std::uint32_t order = swapped_ ? swapped(magic) : magic;
  if (!in_ || (order != kMicroseconds && order != kNanoseconds))
    throw InputError(place_, "is not a capture of packets (pcap, pcapng)", "give a .pcap file");
  interfaces_.push_back({.link = number(header.data() + 20) & 0xFFFF,
                         .resolution = static_cast<std::uint8_t>(order == kNanoseconds ? 9 : 6)});
  offset_ = kFileHeader;
}

std::uint32_t PcapReader::number(const std::byte* at) const {
  return swapped_ ? swapped(little(at)) : little(at);
}

std::uint16_t PcapReader::small_number(const std::byte* at) const {
  const auto [first, second] =
      std::pair(std::to_integer<unsigned>(at[0]), std::to_integer<unsigned>(at[1]));
  return static_cast<std::uint16_t>(swapped_ ? first << 8 | second : second << 8 | first);
}

void PcapReader::fail_damaged(const std::string& what) const {
  throw DamagedFile(fmt::format("{}: byte {}", place_, offset_),
                    fmt::format("{} after {} packets", what, packets_),
                    "the packets before this byte are intact; copy the file again");
}

void PcapReader::read(std::span<std::byte> bytes) {
  if (bytes.size() > file_size_ - offset_) {
    throw DamagedFile(fmt::format("{}: byte {}", place_, file_size_),
                      fmt::format("the file is cut off after {} packets", packets_),
                      "the packets before this byte are intact");
  }
  in_.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  offset_ += bytes.size();
}

/// What follows the header of the link layer; empty if it is no IPv4.
Bytes PcapReader::ip_packet(Bytes frame, std::uint32_t link) const {
  constexpr std::uint16_t kIpv4 = 0x0800, kVlan = 0x8100;
  const auto after = [&](std::size_t type_at) -> Bytes {
    std::size_t at = type_at;
    while (at + 6 < frame.size() && big16(frame, at) == kVlan) at += 4;
    const bool is_ip = at + 2 < frame.size() && big16(frame, at) == kIpv4;
    return is_ip ? frame.subspan(at + 2) : Bytes{};
  };
  switch (link) {
    case 1:  // Ethernet
      return after(12);
    case 113:  // Linux cooked capture
      return after(14);
    case 276:  // the same, version 2: the type comes first
      return frame.size() > 20 && big16(frame, 0) == kIpv4 ? frame.subspan(20) : Bytes{};
    case 0:  // loopback
      return frame.size() > 4 ? frame.subspan(4) : Bytes{};
    case 101:  // raw IP
      return frame;
    default:
      throw InputError(place_, fmt::format("is a capture on a link of type {}", link),
                       "capture on an Ethernet interface");
  }
}

/// The UDP packet (with its header) in an IP packet, or in the fragments of which this is the last.
std::optional<Bytes> PcapReader::whole_udp(Bytes ip) {
  constexpr std::size_t kIpHeader = 20;
  constexpr unsigned kUdp = 17;
  if (ip.size() < kIpHeader || std::to_integer<unsigned>(ip[0]) >> 4 != 4) return std::nullopt;
  const std::size_t header = 4 * (std::to_integer<std::size_t>(ip[0]) & 0xF);
  const std::size_t length = std::min<std::size_t>(big16(ip, 2), ip.size());
  if (std::to_integer<unsigned>(ip[9]) != kUdp || header < kIpHeader || length < header)
    return std::nullopt;
  const std::uint16_t flags = big16(ip, 6);
  const std::size_t at = std::size_t{8} * (flags & 0x1FFF);
  const bool more = (flags & 0x2000) != 0;
  const Bytes content = ip.subspan(header, length - header);
  if (at == 0 && !more) return content;
  const FragmentKey key{big32(ip, 12), big32(ip, 16), big16(ip, 4)};
  constexpr std::size_t kMaxOpen = 64;  // packets of which a fragment was lost
  if (fragments_.size() > kMaxOpen) fragments_.clear();
  Fragments& parts = fragments_[key];
  parts.bytes.resize(std::max(parts.bytes.size(), at + content.size()));
  std::copy(content.begin(), content.end(), parts.bytes.begin() + static_cast<std::ptrdiff_t>(at));
  parts.received += content.size();
  if (!more) parts.total = at + content.size();
  if (parts.total == 0 || parts.received < parts.total) return std::nullopt;
  joined_ = std::move(parts.bytes);
  fragments_.erase(key);
  return joined_;
}

const PcapReader::Interface* PcapReader::next_frame_of_pcap() {
  if (offset_ >= file_size_) return nullptr;
  std::array<std::byte, kPacketHeader> header{};
  read(header);
  const std::uint32_t length = number(header.data() + 8);
  if (length > kMaxPacket) fail_damaged(fmt::format("a packet of {} bytes", length));
  frame_.resize(length);
  read(frame_);
  captured_ = std::chrono::seconds(number(header.data())) +
              time_of(number(header.data() + 4), interfaces_.front().resolution);
  return &interfaces_.front();
}

/// A section header: the byte order of what follows, and no interfaces yet.
void PcapReader::begin_section(Bytes body) {
  if (little(body.data()) != kByteOrder && swapped(little(body.data())) != kByteOrder)
    fail_damaged("a section without its byte order");
  interfaces_.clear();
}

void PcapReader::add_interface(Bytes body) {
  if (body.size() < 8) fail_damaged("an interface that is too short");
  Interface link{.link = small_number(body.data()), .snap = number(body.data() + 4)};
  for (std::size_t at = 8; at + 4 <= body.size();) {
    const std::uint16_t code = small_number(body.data() + at);
    const std::uint16_t length = small_number(body.data() + at + 2);
    if (code == 0 || at + 4 + length > body.size()) break;
    const std::byte* value = body.data() + at + 4;
    if (code == kTimeResolution && length == 1)
      link.resolution = std::to_integer<std::uint8_t>(*value);
    if (code == kTimeOffset && length == 8)
      link.offset = std::chrono::seconds(number(value + (swapped_ ? 4 : 0)));
    at += 4 + (length + 3U) / 4 * 4;
  }
  interfaces_.push_back(link);
}

/// The packet of a block, whose time is at `times_at`, followed by its length and its content.
const PcapReader::Interface* PcapReader::take_packet(Bytes body, std::uint32_t interface,
                                                     std::size_t times_at) {
  if (body.size() < times_at + 16) fail_damaged("a packet that is too short");
  if (interface >= interfaces_.size()) fail_damaged("a packet of an unknown interface");
  const std::uint32_t length = number(body.data() + times_at + 8);
  const Bytes content = body.subspan(times_at + 16);
  if (length > content.size()) fail_damaged(fmt::format("a packet of {} bytes", length));
  const std::uint64_t ticks =
      std::uint64_t{number(body.data() + times_at)} << 32 | number(body.data() + times_at + 4);
  const Interface& link = interfaces_[interface];
  captured_ = time_of(ticks, link.resolution) + link.offset;
  frame_.assign(content.begin(), content.begin() + length);
  return &link;
}

const PcapReader::Interface* PcapReader::next_frame_of_pcapng() {
  while (offset_ < file_size_) {
    std::array<std::byte, 12> header{};  // the type, the length, and of a section its byte order
    read(header);
    const bool is_section = little(header.data()) == kSection;
    if (is_section) swapped_ = little(header.data() + 8) != kByteOrder;
    const std::uint32_t length = number(header.data() + 4);
    if (length < 16 && !(length == 12 && !is_section))
      fail_damaged(fmt::format("a block of {} bytes", length));
    if (length > 2 * kMaxPacket || length % 4 != 0)
      fail_damaged(fmt::format("a block of {} bytes", length));
    if (length == 12) continue;  // without content
    std::vector<std::byte> block(header.begin() + 8, header.end());
    block.resize(length - 8);  // with the length at its end
    read(std::span(block).subspan(4));
    const Bytes body = Bytes(block).first(block.size() - 4);
    if (is_section) begin_section(body);
    switch (is_section ? 0 : number(header.data())) {
      case kInterface:
        add_interface(body);
        break;
      case kEnhancedPacket:
        return take_packet(body, number(body.data()), 4);
      case kObsoletePacket:
        return take_packet(body, small_number(body.data()), 4);
      case kSimplePacket: {
        if (interfaces_.empty()) fail_damaged("a packet of an unknown interface");
        const Interface& link = interfaces_.front();
        std::size_t kept = std::min<std::size_t>(number(body.data()), body.size() - 4);
        if (link.snap > 0) kept = std::min<std::size_t>(kept, link.snap);
        frame_.assign(body.begin() + 4, body.begin() + 4 + static_cast<std::ptrdiff_t>(kept));
        return &link;
      }
      default:
        break;  // names, statistics
    }
  }
  return nullptr;
}

std::optional<Datagram> PcapReader::next() {
  constexpr std::size_t kUdpHeader = 8;
  while (const Interface* link = is_pcapng_ ? next_frame_of_pcapng() : next_frame_of_pcap()) {
    ++packets_;
    const auto udp = whole_udp(ip_packet(frame_, link->link));
    if (!udp || udp->size() < kUdpHeader) continue;
    return Datagram{captured_, big16(*udp, 2), udp->subspan(kUdpHeader)};
  }
  return std::nullopt;
}

}  // namespace lidarena::dataset
