// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace lidarena::fuzz {

/// A reader that is fed broken input. Whatever the bytes, it may refuse them with an InputError and
/// nothing else: any other exception, a crash or a sanitizer's complaint is a defect.
struct Target {
  std::string name;
  std::vector<std::string> corpus;             ///< sound input, to be broken
  std::function<void(std::string_view)> read;  ///< InputErrors are caught inside
};

/// All of them; corpora are made in memory.
const std::vector<Target>& targets();
/// Throws std::out_of_range for an unknown name.
const Target& target(std::string_view name);

}  // namespace lidarena::fuzz
