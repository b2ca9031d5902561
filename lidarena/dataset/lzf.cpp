// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/lzf.hpp"

namespace lidarena {
namespace {

constexpr std::size_t kLiteralLimit = 32;
/// Three bytes give at most 264: no input expands further, so a false size costs no memory.
constexpr std::size_t kMaxExpansion = 88;

}  // namespace

std::optional<std::string> expand_lzf(std::string_view input, std::size_t size) {
  if (size / kMaxExpansion > input.size()) return std::nullopt;
  std::string out;
  out.reserve(size);
  std::size_t at = 0;
  const auto byte = [&] {
    return static_cast<std::size_t>(static_cast<unsigned char>(input[at++]));
  };
  while (at < input.size()) {
    const std::size_t control = byte();
    if (control < kLiteralLimit) {
      const std::size_t length = control + 1;
      if (length > input.size() - at || length > size - out.size()) return std::nullopt;
      out.append(input.substr(at, length));
      at += length;
      continue;
    }
    std::size_t length = control >> 5;
    if (at + (length == 7 ? 2 : 1) > input.size()) return std::nullopt;
    if (length == 7) length += byte();
    length += 2;
    const std::size_t back = ((control & 31) << 8) + byte() + 1;
    if (back > out.size() || length > size - out.size()) return std::nullopt;
    for (std::size_t i = 0; i < length; ++i) out.push_back(out[out.size() - back]);  // may overlap
  }
  if (out.size() != size) return std::nullopt;
  return out;
}

}  // namespace lidarena
