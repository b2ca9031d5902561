// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "lidarena/base/config.hpp"
#include "lidarena/flight/recording.hpp"
#include "lidarena/flight/replay_flight.hpp"

namespace lidarena::gazebo_plugin {

/// The elements inside the <plugin> that moves a model along a recorded trajectory.
struct FlightPluginConfig {
  std::string trajectory;
  double thin_s = 0.01;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("trajectory", self.trajectory, "",
      "TUM file (t x y z qx qy qz qw) of the model's frame, also searched in the simulator's "
      "resource path; its first pose is at simulated time 0");
    v("thin_s", self.thin_s, "s",
      "minimum time between poses, closer ones are left out: their rounding would disturb the IMU",
      at_least(0));
  }
};

/// `file`: where the trajectory was found. Throws InputError with file and line.
inline flight::ReplayFlight load_flight(const FlightPluginConfig& config, const std::string& file) {
  return flight::ReplayFlight(flight::thinned(flight::read_recording(file), config.thin_s), file);
}

}  // namespace lidarena::gazebo_plugin
