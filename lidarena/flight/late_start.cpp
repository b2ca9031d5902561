// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/flight/late_start.hpp"

namespace lidarena::flight {

Motion LateStart::at(Time t) const {
  if (t >= Time{0}) return whole_->at(t + begin_);
  Motion rest;
  rest.world_from_body = pose_at(Time{0});
  return rest;
}

}  // namespace lidarena::flight
