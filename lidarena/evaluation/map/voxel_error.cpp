// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/map/voxel_error.hpp"

#include <cmath>
#include <vector>

#include "lidarena/evaluation/map/map_error.hpp"

namespace lidarena::evaluation {

VoxelError voxel_error(const MortonOrder& order, std::span<const PointScore> scores) {
  constexpr unsigned kBits = 9;  // 8 x 8 x 8 cells of the Morton order
  static_assert(VoxelError::kVoxel_m == 8.0 * MortonOrder::kCell_m);
  std::vector<double> rms;
  double shares = 0.0;
  for (std::size_t begin = 0; begin < scores.size();) {
    const std::uint64_t voxel = order.entries[begin].code >> kBits;
    std::size_t end = begin;
    std::size_t outliers = 0;
    double squares = 0.0;
    for (; end < scores.size() && order.entries[end].code >> kBits == voxel; ++end) {
      const double d = scores[end].distance;
      squares += d * d;
      if (d > MapError::kOutlier_m) ++outliers;
    }
    const auto count = static_cast<double>(end - begin);
    rms.push_back(std::sqrt(squares / count));
    shares += static_cast<double>(outliers) / count;
    begin = end;
  }
  VoxelError error;
  error.voxels = rms.size();
  error.rms_m = results::summarize(rms);
  if (!rms.empty()) error.outliers_percent = 100.0 * shares / static_cast<double>(rms.size());
  return error;
}

}  // namespace lidarena::evaluation
