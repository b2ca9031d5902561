// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace lidarena::dataset {

/// Expands LZF data (as in binary_compressed PCD); none if `input` is not the whole of exactly
/// `size` bytes.
std::optional<std::string> expand_lzf(std::string_view input, std::size_t size);

}  // namespace lidarena::dataset
