// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "lidarena/study/study_spec.hpp"

namespace lidarena::study {

/// Adds programs of others to the study as algorithms: names in configs/programs, or files;
/// `installed` stands for all of configs/programs that are installed here. Throws InputError that
/// says how to install those that are named and are not installed.
void add_programs(StudySpec& spec, const std::vector<std::string>& names,
                  const stages::ConfigFolder& configs);

}  // namespace lidarena::study
