// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

#include "lidarena/base/scan.hpp"
#include "lidarena/dataset/message_stream.hpp"

namespace lidarena {

/// Whether `type` is the CustomMsg of one of Livox's ROS 2 drivers.
bool is_livox_type(std::string_view type);

/// A CustomMsg in CDR as a scan: header.stamp (the first point's time), offset_time (ns), position
/// (m), reflectivity as intensity, line as ring. Points without a return (0 0 0) are dropped, tags
/// are not looked at. If all returns have the offset 0, the scan is untimed. Throws InputError
/// (place `place`) when the message is broken.
Scan decode_livox(Bytes message, std::string_view place, Encoding encoding = Encoding::kCdr);

}  // namespace lidarena
