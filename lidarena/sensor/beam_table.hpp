// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <mutex>
#include <span>
#include <vector>

#include "lidarena/sensor/scan_pattern.hpp"

namespace lidarena {

/// Beams of a pattern that repeats, each scan of it computed once, when first asked for, and kept:
/// 12 bytes a beam, since all but the directions is the same in every scan. The beams are the
/// pattern's own to the last bit, whoever asks first. Thread safe.
class BeamTable {
 public:
  static constexpr std::size_t kMostBytes = 64UL << 20U;  ///< larger tables are not kept

  /// Keeps a reference to `pattern`.
  explicit BeamTable(const ScanPattern& pattern);

  /// Beams of scan `index`, in `storage` or in the table.
  std::span<const Beam> beams(std::uint64_t index, std::vector<Beam>& storage) const;

  /// Bytes that the table takes once all scans are in it.
  std::size_t bytes() const;

 private:
  struct Slot {
    std::once_flag once;
    std::vector<Eigen::Vector3f> directions;
  };

  bool differs_in_directions_alone(const std::vector<Beam>& beams) const;

  const ScanPattern& pattern_;
  std::vector<Beam> first_;          ///< scan 0
  mutable std::vector<Slot> slots_;  ///< of the scans until it repeats; none if they are not kept
};

}  // namespace lidarena
