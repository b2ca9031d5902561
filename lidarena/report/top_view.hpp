// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "lidarena/base/trajectory.hpp"
#include "lidarena/dataset/points/cloud.hpp"

namespace lidarena::report {

/// A map seen from above like an X-ray image: vertical surfaces are dark because many points fall
/// into one pixel, and the color is the mean point-to-mesh distance there (see distance_color). The
/// true path (gray), the estimated path (orange) and a scale bar are drawn over it.
struct TopView {
  std::string title;
  const dataset::Cloud* map = nullptr;  ///< in the mesh's frame, with distances
  const Trajectory* truth = nullptr;
  std::vector<Eigen::Vector3d> estimate;  ///< positions in the mesh's frame
  int width = 760;                        ///< pixels
};

/// One self-contained SVG element.
std::string top_view_svg(const TopView& view);

}  // namespace lidarena::report
