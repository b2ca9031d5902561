// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/cast_order.hpp"

namespace lidarena::sensor {

CastOrder::CastOrder(std::span<const Beam> beams) {
  std::size_t lasers = 1;
  while (lasers < beams.size() && beams[lasers].ring != beams[0].ring) ++lasers;
  if (lasers == beams.size()) lasers = 1;  // the first ring never recurs
  place_.resize(kPacketSize * lasers);
  for (std::size_t firing = 0; firing < kPacketSize; ++firing) {
    for (std::size_t laser = 0; laser < lasers; ++laser) {
      place_[firing * lasers + laser] = static_cast<std::uint32_t>(laser * kPacketSize + firing);
    }
  }
}

}  // namespace lidarena::sensor
