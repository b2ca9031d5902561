// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include "lidarena/base/trajectory.hpp"

namespace lidarena::dds {

/// The same stamps, and poses that differ by no more than the nine digits of a file.
inline void expect_same_poses(const Trajectory& a, const Trajectory& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a.poses()[i].stamp, b.poses()[i].stamp) << i;
    const Pose difference = a.poses()[i].world_from_body.inverse() * b.poses()[i].world_from_body;
    EXPECT_LT((difference.matrix() - Pose::Identity().matrix()).cwiseAbs().maxCoeff(), 1e-7) << i;
  }
}

}  // namespace lidarena::dds
