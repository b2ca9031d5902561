// SPDX-License-Identifier: BSD-3-Clause
// Parallel for builds without oneTBB (adapters/gazebo/core): everything runs on the calling thread.
// Results are bit-identical to those of parallel.cpp.
#include "lidarena/base/parallel.hpp"

namespace lidarena {

Parallel::Parallel(int /*threads*/) : threads_(1) {}

void Parallel::run(std::size_t count, const std::function<void(std::size_t)>& task) const {
  for (std::size_t i = 0; i < count; ++i) task(i);
}

}  // namespace lidarena
