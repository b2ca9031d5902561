// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "lidarena/base/pose.hpp"

namespace lidarena::dataset {

class PartFile;

/// The return from which a point of a map was made.
struct ReturnOrigin {
  std::uint32_t scan = 0;   ///< index among the scans of the LiDAR
  std::uint32_t point = 0;  ///< index into the scored returns of the scan
  double time_s = 0.0;      ///< stamp of the return
};

/// A map: points in the world frame (m) from `origin` on, optionally with intensity, the return of
/// each point, and distance.
struct Cloud {
  std::vector<Eigen::Vector3f> points;
  std::vector<float> intensity;       ///< empty or one per point
  std::vector<ReturnOrigin> origins;  ///< empty or one per point; scans ascend
  std::vector<float> distance;  ///< empty or one per point: to the mesh, m; NaN if there is none
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< world coordinates of (0, 0, 0) of `points`
};

/// Reads .ply (ascii, binary little endian) or .pcd (ascii, binary, binary_compressed). Every point
/// is kept, NaN and infinite ones too: evaluation counts them. Throws InputError.
///
/// Map coordinates (UTM) are beyond 10 km, where float rounds to millimeters and more. With
/// `keep_origin`, such points are read relative to the first of them, which becomes Cloud::origin.
Cloud read_cloud(const std::filesystem::path& file, bool keep_origin = false);
/// Writes binary little-endian PLY: x y z (double where `origin` is not zero, else float), float
/// [intensity] [distance], with origins of returns also uint scan point and double time (s). Throws
/// Error when the disk is full.
void write_ply(const std::filesystem::path& file, const Cloud& cloud);
/// Writes such a PLY in parts.
class CloudWriter {
 public:
  /// Which values the points have besides their positions.
  struct Fields {
    bool intensity = false;
    bool distance = false;
    bool origins = false;
    bool far = false;  ///< positions are double, see Cloud::origin
  };
  /// Throws InputError when the folder is missing or read-only.
  CloudWriter(const std::filesystem::path& file, const Fields& fields);
  ~CloudWriter();

  /// Appends points, which have all of the fields. Throws Error when the disk is full.
  void write(const Cloud& part);
  std::size_t size() const { return size_; }
  /// Moves all points by `moved`, in world frames, and completes the file, which is otherwise left
  /// with the ending .part.
  void commit(const Pose& moved = Pose::Identity());

 private:
  std::size_t row_bytes() const;
  void move_points(const Pose& moved);

  Fields fields_;
  std::filesystem::path part_name_;
  std::unique_ptr<PartFile> file_;
  std::uint64_t begin_ = 0;  ///< of the points, bytes
  std::size_t size_ = 0;
};

/// Writes binary PCD: float x y z [intensity] [distance]; origins are left out. Throws Error when
/// the disk is full.
void write_pcd(const std::filesystem::path& file, const Cloud& cloud);

}  // namespace lidarena::dataset
