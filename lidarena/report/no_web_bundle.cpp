// SPDX-License-Identifier: BSD-3-Clause
// Stands in where the viewer is not built.
#include "lidarena/report/web_bundle.hpp"

namespace lidarena {

std::string_view web_bundle(std::string_view) { return {}; }

}  // namespace lidarena
