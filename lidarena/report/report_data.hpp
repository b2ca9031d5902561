// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lidarena/base/config_json.hpp"
#include "lidarena/report/result_table.hpp"

namespace lidarena {

/// What the charts are drawn from; viewer/src/report/data.ts describes it. Curves are thinned to
/// 400 values.
Json report_data(const Results& results);

}  // namespace lidarena
