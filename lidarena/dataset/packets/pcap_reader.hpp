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

/// Reads the UDP packets of a capture file (pcap, microseconds or nanoseconds, either byte order;
/// https://datatracker.ietf.org/doc/draft-ietf-opsawg-pcap/) over IPv4 on Ethernet, Linux cooked
/// capture, loopback or raw IP. Packets that IP has split are joined. All else is skipped.
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
  using FragmentKey = std::tuple<std::uint32_t, std::uint32_t, std::uint16_t>;

  std::uint32_t number(const std::byte* at) const;
  void read(std::span<std::byte> bytes);
  Bytes ip_packet(Bytes frame) const;
  std::optional<Bytes> whole_udp(Bytes ip);

  std::string place_;
  std::ifstream in_;
  std::uint64_t file_size_ = 0;
  std::uint64_t offset_ = 0;
  std::uint64_t packets_ = 0;
  bool swapped_ = false;    ///< the header is in the other byte order
  bool in_ns_ = false;      ///< times have nanoseconds
  std::uint32_t link_ = 0;  ///< type of the link layer
  std::vector<std::byte> frame_;
  std::map<FragmentKey, Fragments> fragments_;
  std::vector<std::byte> joined_;
};

}  // namespace lidarena::dataset
