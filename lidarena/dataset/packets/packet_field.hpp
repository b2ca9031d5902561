// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstring>

#include "lidarena/dataset/byte_stream.hpp"

namespace lidarena::dataset {

/// The little-endian number at `offset` of a packet, which the caller knows to be long enough.
template <class T>
T at(Bytes packet, std::size_t offset) {
  T value;
  std::memcpy(&value, packet.data() + offset, sizeof value);
  return value;
}

}  // namespace lidarena::dataset
