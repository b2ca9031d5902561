// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "lidarena/base/trajectory.hpp"
#include "lidarena/dataset/points/cloud.hpp"

namespace lidarena {

/// A map seen from above like an X-ray: upright surfaces are dark because many points fall into one
/// pixel, and the color is the mean point-to-mesh distance there (see distance_color). Over it the
/// true path (gray) and the estimated one (orange), and a scale bar.
struct TopView {
  std::string title;
  const Cloud* map = nullptr;  ///< in the mesh's frame, with distances
  const Trajectory* truth = nullptr;
  std::vector<Eigen::Vector3d> estimate;  ///< positions in the mesh's frame
  int width = 760;                        ///< pixels
};

/// One SVG element that carries the picture inside.
std::string top_view_svg(const TopView& view);

}  // namespace lidarena
