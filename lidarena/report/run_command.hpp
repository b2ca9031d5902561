// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "lidarena/results/run_record.hpp"

namespace lidarena::report {

/// The commands that make a run anew: they simulate its dataset (the same bytes with the same
/// version; data that was recorded is used where it is), run the method and score it.
std::string command_of(const results::RunRecord& row);

}  // namespace lidarena::report
