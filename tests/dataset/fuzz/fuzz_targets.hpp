// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace lidarena::dataset::fuzz {

/// A reader to be tested with damaged input. For any bytes, InputError is the only exception
/// allowed: another exception, a crash or a sanitizer report is a defect.
struct Target {
  std::string name;
  std::vector<std::string> corpus;             ///< valid input, to be mutated
  std::function<void(std::string_view)> read;  ///< InputErrors are caught inside
};

/// All targets; their corpora are generated.
const std::vector<Target>& targets();
/// Throws std::out_of_range for an unknown name.
const Target& target(std::string_view name);

}  // namespace lidarena::dataset::fuzz
