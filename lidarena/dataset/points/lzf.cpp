// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/points/lzf.hpp"

#include <lzf.h>

#include <limits>

namespace lidarena::dataset {

std::optional<std::string> expand_lzf(std::string_view input, std::size_t size) {
  // Three bytes expand to at most 264, so a false size in a file costs no memory.
  constexpr std::size_t kMaxExpansion = 88;
  constexpr std::size_t kMaxSize = std::numeric_limits<unsigned>::max();
  if (size / kMaxExpansion > input.size() || size > kMaxSize) return std::nullopt;
  if (input.empty() || size == 0) {
    return input.size() == size ? std::optional(std::string()) : std::nullopt;
  }
  std::string out(size, '\0');
  const unsigned expanded = lzf_decompress(input.data(), static_cast<unsigned>(input.size()),
                                           out.data(), static_cast<unsigned>(size));
  if (expanded != size) return std::nullopt;
  return out;
}

}  // namespace lidarena::dataset
