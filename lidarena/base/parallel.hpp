// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

namespace lidarena {

/// Points per task of loops that transform each point of a scan: about 0.1 ms of work.
inline constexpr std::size_t kPointGrain = 2048;

/// Parallel loops with their own thread limit (nothing is process-wide). Work is divided into
/// blocks of a fixed size, and partial results are joined in block order, so results are
/// bit-identical for any number of threads. Copies share the same workers.
class Parallel {
 public:
  /// `threads` workers, 0 = one per hardware thread.
  explicit Parallel(int threads = 0);

  int threads() const { return threads_; }

  /// Calls body(begin, end) for consecutive blocks of `grain` indices that cover [0, count).
  template <class Body>
  void for_blocks(std::size_t count, std::size_t grain, Body&& body) const {
    grain = std::max<std::size_t>(grain, 1);
    run((count + grain - 1) / grain,
        [&](std::size_t block) { body(block * grain, std::min(count, (block + 1) * grain)); });
  }

  /// Calls body(i) for each i in [0, count).
  template <class Body>
  void for_each(std::size_t count, std::size_t grain, Body&& body) const {
    for_blocks(count, grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) body(i);
    });
  }

  /// Folds body(begin, end) -> T over all blocks with join(T&, const T&), in block order.
  template <class T, class Body, class Join>
  T reduce(std::size_t count, std::size_t grain, T identity, Body&& body, Join&& join) const {
    grain = std::max<std::size_t>(grain, 1);
    std::vector<T> partial((count + grain - 1) / grain, identity);
    run(partial.size(), [&](std::size_t block) {
      partial[block] = body(block * grain, std::min(count, (block + 1) * grain));
    });
    T total = std::move(identity);
    for (const T& part : partial) join(total, part);
    return total;
  }

 private:
  /// Calls task(0) ... task(count - 1), in no particular order; rethrows the first exception.
  void run(std::size_t count, const std::function<void(std::size_t)>& task) const;

  struct Arena;
  int threads_;
  std::shared_ptr<Arena> arena_;
};

}  // namespace lidarena
