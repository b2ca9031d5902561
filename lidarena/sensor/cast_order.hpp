// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lidarena/sensor/scan_pattern.hpp"

namespace lidarena {

/// The order in which a block of shots is cast. Eight rays that look nearly alike are followed
/// through the world together (see RayOrder), and shots fired one after the other seldom do: the
/// next is the next laser. So tiles of eight firings of all lasers are cast laser by laser.
class CastOrder {
 public:
  static constexpr std::size_t kTogether = 8;

  /// From a scan's beams: the lasers fire in turn, so the ring comes back once all have fired.
  explicit CastOrder(std::span<const Beam> beams);

  /// Shots that belong together; blocks of shots should be multiples of it.
  std::size_t tile() const { return place_.size(); }
  /// Place in the casting order of shot `i` of a block of `count` shots. Shots beyond the last
  /// whole tile are cast as they come.
  std::size_t place(std::size_t i, std::size_t count) const {
    const std::size_t within = i % tile();
    const std::size_t begin = i - within;
    return begin + tile() <= count ? begin + place_[within] : i;
  }

 private:
  std::vector<std::uint32_t> place_;  ///< of each shot of a tile
};

}  // namespace lidarena
