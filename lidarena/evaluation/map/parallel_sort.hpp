// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <span>

#include "lidarena/base/parallel.hpp"

namespace lidarena::evaluation {

/// Sorts blocks in parallel, then merges neighboring blocks. No two of `values` may be equal (or
/// equal ones must be interchangeable), so that the result is the same on any number of threads.
template <class T>
void parallel_sort(std::span<T> values, const Parallel& parallel) {
  constexpr std::size_t kRun = std::size_t{1} << 16U;
  parallel.for_blocks(values.size(), kRun, [&](std::size_t begin, std::size_t end) {
    std::sort(values.begin() + static_cast<std::ptrdiff_t>(begin),
              values.begin() + static_cast<std::ptrdiff_t>(end));
  });
  for (std::size_t run = kRun; run < values.size(); run *= 2) {
    parallel.for_blocks(values.size(), 2 * run, [&](std::size_t begin, std::size_t end) {
      const std::span<T> both = values.subspan(begin, end - begin);
      if (both.size() <= run) return;
      std::inplace_merge(both.begin(), both.begin() + static_cast<std::ptrdiff_t>(run), both.end());
    });
  }
}

}  // namespace lidarena::evaluation
