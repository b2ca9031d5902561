// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <mutex>
#include <span>
#include <vector>

#include "lidarena/sensor/scan_pattern.hpp"

namespace lidarena::sensor {

/// Cache of the beams of a repeating pattern. Each scan is computed on first use and stored with 12
/// bytes per beam: only the directions differ between scans. Returns bit for bit what the pattern
/// returns, whichever thread asks first. Thread safe.
class BeamTable {
 public:
  static constexpr std::size_t kMaxBytes = 64UL << 20U;  ///< larger tables are not stored

  /// Keeps a reference to `pattern`.
  explicit BeamTable(const ScanPattern& pattern);

  /// Beams of scan `index`; the span refers to `storage` or to the table.
  std::span<const Beam> beams(std::uint64_t index, std::vector<Beam>& storage) const;

  /// Memory of the table, in bytes, once all scans are in it.
  std::size_t bytes() const;

 private:
  struct Slot {
    std::once_flag once;
    std::vector<Eigen::Vector3f> directions;
  };

  bool differs_only_in_directions(const std::vector<Beam>& beams) const;

  const ScanPattern& pattern_;
  std::vector<Beam> first_;          ///< scan 0
  mutable std::vector<Slot> slots_;  ///< one per scan of a period; empty if scans are not stored
};

}  // namespace lidarena::sensor
