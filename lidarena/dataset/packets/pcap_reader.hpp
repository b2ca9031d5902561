// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "lidarena/base/time.hpp"
#include "lidarena/dataset/byte_stream.hpp"

namespace lidarena::dataset {

/// The content of a UDP packet; valid until the next one is read.
struct Datagram {
  Time captured{0};        ///< since 1970, by the clock of the computer
  std::uint16_t port = 0;  ///< destination
  Bytes payload;
};

/// Reads the UDP packets of a capture file: pcap (microseconds or nanoseconds;
/// https://datatracker.ietf.org/doc/draft-ietf-opsawg-pcap/) or pcapng
/// (https://datatracker.ietf.org/doc/draft-ietf-opsawg-pcapng/), in either byte order, over IPv4 on
/// Ethernet, Linux cooked capture, loopback or raw IP. Packets that IP has split are joined. All
/// else is skipped. A pcapng packet without a time has that of the packet before.
class PcapReader {
 public:
  /// Throws InputError when the file is missing or is no such capture.
  explicit PcapReader(const std::filesystem::path& file);
  /// The next packet; empty at the end. Throws DamagedFile when the file is cut off.
  std::optional<Datagram> next();

 private:
  /// An IP packet of which some fragments are missing.
  struct Fragments {
    std::vector<std::byte> bytes;
    std::size_t received = 0;
    std::size_t total = 0;  ///< 0: unknown
  };
  /// A link that packets were captured on.
  struct Interface {
    std::uint32_t link = 0;       ///< type of the link layer
    std::uint32_t snap = 0;       ///< bytes that are kept of a packet; 0: all
    std::uint8_t resolution = 6;  ///< of times: 10^-n s, or 2^-n s with the upper bit
    Time offset{0};               ///< added to times
  };
  using FragmentKey = std::tuple<std::uint32_t, std::uint32_t, std::uint16_t>;

  std::uint32_t number(const std::byte* at) const;
  std::uint16_t small_number(const std::byte* at) const;
  /// Reads the next packet into frame_; its interface, or null at the end.
  const Interface* next_frame_of_pcap();
  const Interface* next_frame_of_pcapng();
  void begin_section(Bytes body);
  void add_interface(Bytes body);
  const Interface* take_packet(Bytes body, std::uint32_t interface, std::size_t times_at);
  [[noreturn]] void fail_damaged(const std::string& what) const;
  void read(std::span<std::byte> bytes);
  Bytes ip_packet(Bytes frame, std::uint32_t link) const;
  std::optional<Bytes> whole_udp(Bytes ip);

  std::string place_;
  std::ifstream in_;
  std::uint64_t file_size_ = 0;
  std::uint64_t offset_ = 0;
  std::uint64_t packets_ = 0;
  bool swapped_ = false;  ///< the header is in the other byte order
  bool is_pcapng_ = false;
  std::vector<Interface> interfaces_;  ///< of the section; pcap has one
  Time captured_{0};                   ///< of the packet in frame_
  std::vector<std::byte> frame_;
  std::map<FragmentKey, Fragments> fragments_;
  std::vector<std::byte> joined_;
};

}  // namespace lidarena::dataset
