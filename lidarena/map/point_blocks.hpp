// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace lidarena::map {

/// Memory for many short lists of points, allocated in pages instead of one heap block per list. A
/// block holds 1, 2, 4, 8 ... points (its level is the exponent); freed blocks are reused.
class PointBlocks {
 public:
  static constexpr std::size_t capacity(int level) { return std::size_t{1} << level; }

  /// Memory for capacity(level) points, not initialized; its address does not change until
  /// released.
  Eigen::Vector3f* allocate(int level);
  void release(Eigen::Vector3f* block, int level);
  std::size_t memory_bytes() const;

 private:
  static constexpr std::size_t kPagePoints = 4096;  ///< 48 KiB; no block is larger

  std::vector<std::unique_ptr<Eigen::Vector3f[]>> pages_;
  std::size_t used_ = kPagePoints;                   ///< points handed out of the last page
  std::vector<std::vector<Eigen::Vector3f*>> free_;  ///< by level
};

}  // namespace lidarena::map
