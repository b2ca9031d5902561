// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace lidarena::dataset {

/// MD5 (RFC 1321) as 32 hexadecimal digits. A name for message types, no protection.
std::string md5_of(std::string_view text);

}  // namespace lidarena::dataset
