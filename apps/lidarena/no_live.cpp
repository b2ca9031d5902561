// SPDX-License-Identifier: BSD-3-Clause
#include "adapters/live/run_node.hpp"
#include "apps/lidarena/live_options.hpp"
#include "lidarena/base/error.hpp"

namespace lidarena {
namespace {

constexpr const char* kNoLiveTopics = "this build has no live topics (it needs Cyclone DDS)";

}  // namespace

void add_live_run(CLI::App&, live::LiveRun&) {}

void add_live_simulation(CLI::App&, live::LiveSimulation&) {}

namespace live {

odometry::RunSummary run_live(const LiveRun&, const stages::RunRequest&,
                              const stages::ConfigFolder&, const std::filesystem::path&,
                              const Parallel&, LogSink&) {
  throw Error(kNoLiveTopics);
}

odometry::RunSummary run_node(const stages::ExternalProgram& program, const stages::RunRequest&,
                              const std::filesystem::path&, const Parallel&, LogSink&) {
  throw InputError(program.name, kNoLiveTopics);
}

PublishedFlight simulate_live(const LiveSimulation&, stages::SimulateRequest,
                              const std::filesystem::path&, const Parallel&, LogSink&) {
  throw Error(kNoLiveTopics);
}

}  // namespace live
}  // namespace lidarena
