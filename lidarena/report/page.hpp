// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "lidarena/report/result_table.hpp"

namespace lidarena {

/// The report as one HTML file that needs nothing else: no network, no script.
std::string html_page(const Results& results);

}  // namespace lidarena
