// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace lidarena {

/// Expands LZF data (as in binary_compressed PCD): a control byte below 32 starts that many plus
/// one literal bytes; any other holds in its upper 3 bits a length (7: one more byte adds to it)
/// and in its lower 5, with the byte after, how far back to copy length + 2 bytes from. Empty if
/// `input` is not the whole of exactly `size` bytes.
std::optional<std::string> expand_lzf(std::string_view input, std::size_t size);

}  // namespace lidarena
