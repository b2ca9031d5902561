// SPDX-License-Identifier: BSD-3-Clause
// Replaces the generated web_bundle.cpp where the viewer is not built.
#include "lidarena/report/web_bundle.hpp"

namespace lidarena::report {

std::string_view web_bundle(std::string_view) { return {}; }

}  // namespace lidarena::report
