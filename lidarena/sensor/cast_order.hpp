// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lidarena/sensor/scan_pattern.hpp"

namespace lidarena::sensor {

/// Order in which a block of shots is cast. The ray caster is fastest if the eight rays of a packet
/// have similar directions (see RayOrder). Consecutive shots do not, since each comes from another
/// laser. So a tile of eight firings of all lasers is cast laser by laser.
class CastOrder {
 public:
  static constexpr std::size_t kPacketSize = 8;

  /// Finds the number of lasers from a scan's beams: they fire in turn, so the first ring recurs
  /// once all have fired.
  explicit CastOrder(std::span<const Beam> beams);

  /// Number of shots of a tile; the size of a block should be a multiple of it.
  std::size_t tile() const { return place_.size(); }
  /// Position in the casting order of shot `i` of a block of `count` shots. Shots after the last
  /// whole tile are cast in firing order.
  std::size_t place(std::size_t i, std::size_t count) const {
    const std::size_t within = i % tile();
    const std::size_t begin = i - within;
    return begin + tile() <= count ? begin + place_[within] : i;
  }

 private:
  std::vector<std::uint32_t> place_;  ///< position of each shot of a tile
};

}  // namespace lidarena::sensor
