// SPDX-License-Identifier: BSD-3-Clause
#include "apps/lidarena/run_live.hpp"
#include "lidarena/base/error.hpp"

namespace lidarena {

void add_live_run(CLI::App&, LiveRun&) {}

odometry::RunSummary run_live(const LiveRun&, const study::RunRequest&, const study::ConfigFolder&,
                              const std::filesystem::path&, const Parallel&, LogSink&) {
  throw Error("this build has no live topics");
}

}  // namespace lidarena
