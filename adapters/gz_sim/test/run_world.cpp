// SPDX-License-Identifier: BSD-3-Clause
// Runs a world without a display until a plugin stops it. usage: run_world WORLD [SECONDS]
// Systems and files are searched as the simulator does: IGN_GAZEBO_SYSTEM_PLUGIN_PATH,
// IGN_GAZEBO_RESOURCE_PATH (GZ_SIM_... in Harmonic and later).
#include <cstdio>
#include <cstdlib>

#ifdef LIDARENA_GZ_SIM
#include <gz/common/Console.hh>
#include <gz/sim/Server.hh>
#include <gz/sim/ServerConfig.hh>
namespace gz = ::gz;
namespace sim = ::gz::sim;
#else
#include <ignition/common/Console.hh>
#include <ignition/gazebo/Server.hh>
#include <ignition/gazebo/ServerConfig.hh>
namespace gz = ::ignition;
namespace sim = ::ignition::gazebo;
#endif

int main(int argc, char** argv) {
  constexpr int kMessages = 3;  // verbosity
  constexpr double kStepsPerSecond = 1000.0;
  if (argc < 2) {
    std::fprintf(stderr, "usage: run_world WORLD [SECONDS]\n");
    return 2;
  }
  gz::common::Console::SetVerbosity(kMessages);
  sim::ServerConfig config;
  if (!config.SetSdfFile(argv[1])) return 2;
  sim::Server server(config);
  const double seconds = argc > 2 ? std::atof(argv[2]) : 0.0;
  const auto steps = static_cast<std::uint64_t>(kStepsPerSecond * seconds);  // 0: no limit
  return server.Run(/*blocking=*/true, steps, /*paused=*/false) ? 0 : 1;
}
