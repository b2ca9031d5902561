// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/base/parallel.hpp"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <optional>
#include <thread>

namespace lidarena {

struct Parallel::Arena {
  explicit Arena(int threads) : arena(threads) {
    // By default oneTBB starts at most one worker per core. Raising this limit does not affect
    // other arenas, which keep their own limits.
    const auto cores = static_cast<int>(std::thread::hardware_concurrency());
    if (threads > cores) {
      ceiling.emplace(tbb::global_control::max_allowed_parallelism,
                      static_cast<std::size_t>(threads));
    }
  }
  std::optional<tbb::global_control> ceiling;
  tbb::task_arena arena;
};

Parallel::Parallel(int threads)
    : threads_(threads > 0 ? threads
                           : std::max(1, static_cast<int>(std::thread::hardware_concurrency()))) {
  if (threads_ > 1) arena_ = std::make_shared<Arena>(threads_);
}

void Parallel::run(std::size_t count, const std::function<void(std::size_t)>& task) const {
  if (!arena_ || count < 2) {
    for (std::size_t i = 0; i < count; ++i) task(i);
    return;
  }
  arena_->arena.execute([&] {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, count, 1),
        [&](const tbb::blocked_range<std::size_t>& range) {
          for (std::size_t i = range.begin(); i < range.end(); ++i) task(i);
        },
        tbb::simple_partitioner{});
  });
}

}  // namespace lidarena
