// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

namespace lidarena::report {

/// A file made by viewer/build.mjs, embedded in the binary: view.js, view.css, report.js,
/// report.css, figures.cjs (for Node.js), licenses.txt. Empty if the build was configured
/// without the viewer (LIDARENA_WITH_VIEWER).
std::string_view web_bundle(std::string_view name);

}  // namespace lidarena::report
