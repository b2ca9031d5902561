// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/md5.hpp"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace lidarena {
namespace {

constexpr std::size_t kBlockBytes = 64;
using State = std::array<std::uint32_t, 4>;

/// Constants of RFC 1321, 3.4: the integer part of 2^32 |sin(i + 1)|.
std::uint32_t sine_of(std::size_t i) {
  return static_cast<std::uint32_t>(
      std::floor(std::abs(std::sin(static_cast<double>(i + 1))) * 4294967296.0));
}

void take_block(const char* block, State& state) {
  constexpr std::array<std::array<int, 4>, 4> kTurns{
      {{7, 12, 17, 22}, {5, 9, 14, 20}, {4, 11, 16, 23}, {6, 10, 15, 21}}};
  std::array<std::uint32_t, 16> words{};
  std::memcpy(words.data(), block, kBlockBytes);  // little endian, as the machine
  auto [a, b, c, d] = state;
  for (std::size_t i = 0; i < kBlockBytes; ++i) {
    const std::size_t round = i / 16;
    const std::array<std::uint32_t, 4> mixed{(b & c) | (~b & d), (b & d) | (c & ~d), b ^ c ^ d,
                                             c ^ (b | ~d)};
    const std::array<std::size_t, 4> word{i, 5 * i + 1, 3 * i + 5, 7 * i};
    const std::uint32_t sum = a + mixed[round] + words[word[round] % 16] + sine_of(i);
    a = d;
    d = c;
    c = b;
    b += std::rotl(sum, kTurns[round][i % 4]);
  }
  state = {state[0] + a, state[1] + b, state[2] + c, state[3] + d};
}

}  // namespace

std::string md5_of(std::string_view text) {
  std::string padded(text);
  padded += '\x80';
  constexpr std::size_t kLengthBytes = 8;
  while (padded.size() % kBlockBytes != kBlockBytes - kLengthBytes) padded += '\0';
  const std::uint64_t bits = 8 * std::uint64_t{text.size()};
  padded.append(reinterpret_cast<const char*>(&bits), sizeof bits);
  State state{0x67452301, 0xefcdab89, 0x98badcfe, 0x10325476};
  for (std::size_t at = 0; at < padded.size(); at += kBlockBytes) {
    take_block(padded.data() + at, state);
  }
  std::string digits;
  for (const std::byte byte : std::as_bytes(std::span(state))) {
    digits += fmt::format("{:02x}", std::to_integer<unsigned>(byte));
  }
  return digits;
}

}  // namespace lidarena
