// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lidarena/base/config_json.hpp"
#include "lidarena/report/result_table.hpp"

namespace lidarena::report {

/// The data of the charts; viewer/src/report/data.ts describes its format. Curves are thinned to at
/// most 400 values.
Json report_data(const Results& results);

}  // namespace lidarena::report
