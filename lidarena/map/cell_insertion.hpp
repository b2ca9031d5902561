// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>

#include "lidarena/map/neighbor.hpp"

namespace lidarena::map {

/// How to add a point to a tree that keeps the point nearest to the center of each cell.
enum class CellInsertion {
  kPlain,    ///< its cell is empty
  kThinned,  ///< with downsampling
  kNone,     ///< the cell has a better point
};

/// Decides by the `neighbors` (m) of `point`, nearest first, without a search of its cell of a grid
/// with voxel size `voxel` (m): if the nearest one is outside the cell on every axis, the cell is
/// empty; if any one is nearer to the cell's center, the point is not needed (FAST-LIO2, section
/// V-E; the shortcuts are those of its program). kThinned if there are no neighbors.
CellInsertion cell_insertion(const Eigen::Vector3f& point, std::span<const Neighbor> neighbors,
                             float voxel);

}  // namespace lidarena::map
