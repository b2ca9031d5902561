// SPDX-License-Identifier: BSD-3-Clause
#include "apps/lidarena/run_live.hpp"
#include "apps/lidarena/run_node.hpp"
#include "apps/lidarena/simulate_live.hpp"
#include "lidarena/base/error.hpp"

namespace lidarena {
namespace {

constexpr const char* kNoLiveTopics = "this build has no live topics (it needs Cyclone DDS)";

}  // namespace

void add_live_run(CLI::App&, LiveRun&) {}

odometry::RunSummary run_live(const LiveRun&, const study::RunRequest&, const study::ConfigFolder&,
                              const std::filesystem::path&, const Parallel&, LogSink&) {
  throw Error(kNoLiveTopics);
}

odometry::RunSummary run_node(const study::ExternalProgram& program, const study::RunRequest&,
                              const std::filesystem::path&, const Parallel&, LogSink&) {
  throw InputError(program.name, kNoLiveTopics);
}

void add_live_simulation(CLI::App&, LiveSimulation&) {}

PublishedFlight simulate_live(const LiveSimulation&, study::SimulateRequest,
                              const std::filesystem::path&, const Parallel&, LogSink&) {
  throw Error(kNoLiveTopics);
}

}  // namespace lidarena
