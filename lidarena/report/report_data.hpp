// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lidarena/base/config_json.hpp"
#include "lidarena/results/run_record.hpp"

namespace lidarena::report {

/// The data of the charts; viewer/src/report/data.ts describes its format. Curves are thinned to at
/// most 400 values.
Json report_data(const results::StudyResults& results);

}  // namespace lidarena::report
