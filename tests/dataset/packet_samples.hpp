// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "lidarena/dataset/packets/ouster_metadata.hpp"
#include "tests/dataset/packed.hpp"

/// Small packets of LiDARs and captures of them, byte by byte.
namespace lidarena::dataset {

inline std::string big(std::uint16_t value) {
  return {static_cast<char>(value >> 8), static_cast<char>(value & 0xFF)};
}

/// An IPv4 packet, or a fragment of one, on Ethernet.
inline std::string ip_frame(const std::string& content, std::uint16_t id, std::size_t offset,
                            bool more) {
  const auto flags = static_cast<std::uint16_t>(offset / 8 | (more ? 0x2000 : 0));
  return std::string(12, '\0') + big(0x0800) + "\x45" + std::string(1, '\0') +
         big(static_cast<std::uint16_t>(20 + content.size())) + big(id) + big(flags) + "\x40\x11" +
         big(0) + std::string("\x7f\0\0\1\x7f\0\0\1", 8) + content;
}

inline std::string udp(const std::string& payload, std::uint16_t port) {
  return big(port) + big(port) + big(static_cast<std::uint16_t>(8 + payload.size())) + big(0) +
         payload;
}

inline std::string pcap(const std::vector<std::string>& frames) {
  std::string file = packed(0xA1B2C3D4U, std::uint16_t{2}, std::uint16_t{4}, 0, 0U, 65535U, 1U);
  for (std::uint32_t i = 0; i < frames.size(); ++i) {
    const auto size = static_cast<std::uint32_t>(frames[i].size());
    file += packed(1'700'000'000U, 100U * i, size, size) + frames[i];
  }
  return file;
}

/// A packet of two columns in which every pixel is `pixel`.
inline std::string ouster_packet(OusterProfile profile, std::uint16_t frame, std::uint16_t column,
                                 const std::string& pixel) {
  const bool legacy = profile == OusterProfile::kLegacy;
  std::string packet = legacy ? "" : packed(std::uint16_t{1}, frame) + std::string(28, '\0');
  for (std::uint16_t i = 0; i < 2; ++i) {
    const auto number = static_cast<std::uint16_t>(column + i);
    packet += packed(std::uint64_t{1000000} + 100000U * number, number);
    packet += legacy ? packed(frame, 0U) : packed(std::uint16_t{1});
    packet += pixel + pixel;
    if (legacy) packet += packed(0xFFFFFFFFU);
  }
  return legacy ? packet : packet + std::string(32, '\0');
}

}  // namespace lidarena::dataset
