// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/md5.hpp"

#include <md5.h>

#include <array>

namespace lidarena::dataset {

std::string md5_of(std::string_view text) {
  std::array<char, MD5_DIGEST_STRING_LENGTH> digits{};
  MD5Data(reinterpret_cast<const std::uint8_t*>(text.data()), text.size(), digits.data());
  return digits.data();
}

}  // namespace lidarena::dataset
