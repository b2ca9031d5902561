// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

#include "lidarena/base/scan.hpp"
#include "lidarena/dataset/messages/message_stream.hpp"

namespace lidarena::dataset {

/// Whether `type` (as spelled in ROS 2) is the CustomMsg of one of Livox's drivers.
bool is_livox_type(std::string_view type);

/// Decodes a CustomMsg: header.stamp (the first point's time), offset_time (ns), position (m),
/// reflectivity as intensity, line as ring. Points without a return (0 0 0) are dropped; tags are
/// ignored. If all returns have the offset 0, the scan is untimed. Throws InputError (place
/// `place`) when the message is damaged.
Scan decode_livox(Bytes message, std::string_view place, Encoding encoding = Encoding::kCdr);

}  // namespace lidarena::dataset
