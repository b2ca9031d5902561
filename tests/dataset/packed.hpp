// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace lidarena::dataset {

/// The bytes of values, one after the other.
template <class... T>
std::string packed(T... values) {
  std::string bytes;
  (bytes.append(reinterpret_cast<const char*>(&values), sizeof(values)), ...);
  return bytes;
}

}  // namespace lidarena::dataset
