// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "lidarena/dataset/byte_stream.hpp"

namespace lidarena::dataset {

inline std::string text_of(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

template <class Message>
bool is_beginning_of(const std::vector<Message>& part, const std::vector<Message>& whole) {
  return part.size() <= whole.size() && std::equal(part.begin(), part.end(), whole.begin());
}

}  // namespace lidarena::dataset
