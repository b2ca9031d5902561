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
constexpr std::uint32_t kNextGeneration = 0x0A0D0D0A;  // pcapng
constexpr std::uint32_t kMaxPacket = 1 << 20;          // bytes; no link carries longer ones

std::uint32_t little(const std::byte* at) {
  std::uint32_t value = 0;
  std::memcpy(&value, at, sizeof value);
  return value;
}

std::uint32_t swapped(std::uint32_t value) {
  return (value >> 24) | ((value >> 8) & 0xFF00) | ((value << 8) & 0xFF0000) | (value << 24);
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
  if (magic == kNextGeneration) {
    throw InputError(place_, "is a capture in the format pcapng",
                     "convert it with 'editcap -F pcap IN OUT'");
  }
  swapped_ = swapped(magic) == kMicroseconds || swapped(magic) == kNanoseconds;
  const std::uint32_t order = swapped_ ? swapped(magic) : magic;
  if (!in_ || (order != kMicroseconds && order != kNanoseconds))
    throw InputError(place_, "is not a capture of packets (pcap)", "give a .pcap file");
  in_ns_ = order == kNanoseconds;
  link_ = number(header.data() + 20) & 0xFFFF;
  offset_ = kFileHeader;
}

std::uint32_t PcapReader::number(const std::byte* at) const {
  return swapped_ ? swapped(little(at)) : little(at);
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
Bytes PcapReader::ip_packet(Bytes frame) const {
  constexpr std::uint16_t kIpv4 = 0x0800, kVlan = 0x8100;
  const auto after = [&](std::size_t type_at) -> Bytes {
    std::size_t at = type_at;
    while (at + 6 < frame.size() && big16(frame, at) == kVlan) at += 4;
    const bool is_ip = at + 2 < frame.size() && big16(frame, at) == kIpv4;
    return is_ip ? frame.subspan(at + 2) : Bytes{};
  };
  switch (link_) {
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
      throw InputError(place_, fmt::format("is a capture on a link of type {}", link_),
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

std::optional<Datagram> PcapReader::next() {
  constexpr std::size_t kUdpHeader = 8;
  while (offset_ < file_size_) {
    std::array<std::byte, kPacketHeader> header{};
    read(header);
    const std::uint32_t length = number(header.data() + 8);
    if (length > kMaxPacket) {
      throw DamagedFile(fmt::format("{}: byte {}", place_, offset_),
                        fmt::format("a packet of {} bytes after {} packets", length, packets_),
                        "the packets before this byte are intact; copy the file again");
    }
    frame_.resize(length);
    read(frame_);
    ++packets_;
    const auto udp = whole_udp(ip_packet(frame_));
    if (!udp || udp->size() < kUdpHeader) continue;
    const Time fraction{std::int64_t{number(header.data() + 4)} * (in_ns_ ? 1 : 1000)};
    return Datagram{std::chrono::seconds(number(header.data())) + fraction, big16(*udp, 2),
                    udp->subspan(kUdpHeader)};
  }
  return std::nullopt;
}

}  // namespace lidarena::dataset
