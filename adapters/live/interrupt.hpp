// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace lidarena::live {

/// From now on Ctrl-C does not end the program; the returned function says whether it was asked to
/// end.
bool (*end_on_interrupt())();

}  // namespace lidarena::live
