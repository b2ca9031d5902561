// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/flight/clearance.hpp"

#include <algorithm>

namespace lidarena::flight {

std::optional<Encounter> first_encounter(const Flight& flight, const world::World& world,
                                         double clearance) {
  constexpr Time kStep = std::chrono::milliseconds(5);
  Eigen::Vector3d queried = flight.pose_at(Time{0}).translation();  // position of the last query
  Eigen::Vector3d last = queried;
  double margin = 0.0;  // path length from `queried` within which no new query is needed
  double flown = 0.0;
  for (Time t{0};; t = std::min(t + kStep, flight.duration())) {
    const Eigen::Vector3d here = flight.pose_at(t).translation();
    flown += (here - last).norm();
    last = here;
    if (flown >= margin) {
      const world::ClosestPoint nearest = world.closest_point(here);
      const bool passes_through = here != queried && !world.visible(queried, here);
      if (passes_through || nearest.distance < clearance) {
        return Encounter{t, here, nearest.point, passes_through ? 0.0 : nearest.distance};
      }
      queried = here;
      margin = nearest.distance - clearance;
      flown = 0.0;
    }
    if (t >= flight.duration()) return std::nullopt;
  }
}

}  // namespace lidarena::flight
