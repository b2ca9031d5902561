// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/trajectory_io.hpp"

#include "lidarena/dataset/kitti.hpp"
#include "lidarena/dataset/text_file.hpp"
#include "lidarena/dataset/tum.hpp"

namespace lidarena {

Trajectory read_trajectory(const std::filesystem::path& file, double rate_hz) {
  TextRows rows(file);
  const auto row = rows.next();
  if (row && row->find(',') != std::string_view::npos) return read_euroc_csv(file);
  const std::size_t columns = row ? split_words(*row).size() : 0;
  if (columns == 12 || columns == 13) {
    const std::filesystem::path times = file.parent_path() / "times.txt";
    return std::filesystem::exists(times) ? read_kitti_poses(file, read_times(times))
                                          : read_kitti_poses(file, rate_hz);
  }
  return read_tum(file);
}

}  // namespace lidarena
