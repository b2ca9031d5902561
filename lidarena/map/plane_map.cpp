// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/map/plane_map.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "lidarena/base/error.hpp"

namespace lidarena::map {
namespace {

constexpr float kMaxLoad = 0.8F;  // of the hash table
constexpr VoxelKey kInvalidKey = ~VoxelKey{0};
constexpr VoxelKey kOtherSide = VoxelKey{1} << 63U;  // a voxel's key has 63 bits

Voxel voxel_of_key(VoxelKey key) {
  const auto index = [key](unsigned shift) {
    return static_cast<int>((key >> shift) & 0x1FFFFFU) - (1 << 20);
  };
  return {index(0), index(21), index(42)};
}

/// xx, yy, zz, xy, xz, yz.
Eigen::Matrix<float, 6, 1> products_of(const Eigen::Vector3f& p) {
  Eigen::Matrix<float, 6, 1> products;
  products << p.x() * p.x(), p.y() * p.y(), p.z() * p.z(), p.x() * p.y(), p.x() * p.z(),
      p.y() * p.z();
  return products;
}

Eigen::Matrix3d symmetric(const Eigen::Matrix<double, 6, 1>& p) {
  Eigen::Matrix3d m;
  m << p[0], p[3], p[4], p[3], p[1], p[5], p[4], p[5], p[2];
  return m;
}

}  // namespace

PlaneMap::PlaneMap(const Options& options)
    : options_(options),
      cells_from_points_((grid_from_points(options.axes) / options.cell_size).cast<float>()) {
  if (!(options.cell_size > 0.0)) throw InputError("cell_size", "must be above 0 m");
  if (options.min_points < 3) throw InputError("min_points", "must be at least 3");
  if (options.max_points < options.min_points)
    throw InputError("max_points", "must not be below min_points");
  if (!(options.min_width > 0.0)) throw InputError("min_width", "must be above 0 m");
  places_.max_load_factor(kMaxLoad);
}

std::uint32_t PlaneMap::cell_for(VoxelKey key) {
  const auto next = static_cast<std::uint32_t>(cells_.size());
  const auto [place, is_new] = places_.try_emplace(key, next);
  if (is_new) {
    if (cells_.size() == cells_.capacity()) cells_.reserve(cells_.size() + cells_.size() / 4 + 256);
    cells_.emplace_back().key = key;
    cells_.back().next_fit = static_cast<std::uint32_t>(options_.min_points);
  }
  return place->second;
}

void PlaneMap::insert(std::span<const Eigen::Vector3f> points, const Sensor& sensor) {
  const auto most = static_cast<std::uint32_t>(options_.max_points);
  VoxelKey known = kInvalidKey;  // neighbors in a scan often share a cell
  std::uint32_t index = 0;
  to_fit_.clear();
  for (const Eigen::Vector3f& point : points) {
    if (!point.allFinite()) continue;
    const Eigen::Vector3f in_cells = cells_from_points_ * point;
    const Voxel voxel = voxel_of(in_cells, 1.0F);
    const VoxelKey key = voxel_key(voxel);
    if (key != known) {
      index = cell_for(key);
      if (is_behind(cells_[index], sensor)) index = cell_for(key | kOtherSide);
    }
    known = key;
    Cell& cell = cells_[index];
    if (cell.count >= most) continue;
    const Eigen::Vector3f off = in_cells - voxel.cast<float>() - Eigen::Vector3f::Constant(0.5F);
    cell.sum += off;
    cell.products += products_of(off);
    if (++cell.count == cell.next_fit) to_fit_.push_back(index);
  }
  for (const std::uint32_t cell : to_fit_) fit(cells_[cell], sensor);
}

bool PlaneMap::is_behind(const Cell& cell, const Sensor& sensor) {
  return sensor && cell.has_plane && cell.plane.normal.dot(*sensor - cell.plane.center) < 0.0F;
}

void PlaneMap::fit(Cell& cell, const Sensor& sensor) const {
  const double n = cell.count;
  const Eigen::Vector3d mean = cell.sum.cast<double>() / n;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes;
  axes.computeDirect(symmetric(cell.products.cast<double>() / n) - mean * mean.transpose());
  const Eigen::Vector3d spread =
      options_.cell_size * options_.cell_size * axes.eigenvalues();  // m^2, ascending
  const Eigen::Matrix3d points_from_grid = grid_from_points(options_.axes).transpose();
  const Eigen::Vector3d middle = voxel_of_key(cell.key).cast<double>().array() + 0.5;
  cell.plane.center = (options_.cell_size * points_from_grid * (middle + mean)).cast<float>();
  cell.plane.normal = (points_from_grid * axes.eigenvectors().col(0)).cast<float>();
  if (sensor && cell.plane.normal.dot(*sensor - cell.plane.center) < 0.0F)
    cell.plane.normal = -cell.plane.normal;
  cell.plane.variance = static_cast<float>(std::max(0.0, spread[0]));
  // The slope of a line through n points, three of which are taken by the plane.
  const double slope = std::sqrt(cell.plane.variance / (std::max(n - 3.0, 1.0) * spread[1]));
  const double excess = std::max(0.0, spread[0] - options_.noise * options_.noise);
  cell.plane.normal_error = static_cast<float>(4.0 * slope + std::sqrt(excess / spread[1]));
  cell.has_plane = spread[1] >= options_.min_width * options_.min_width &&
                   spread[0] <= options_.max_thickness * options_.max_thickness;
  cell.next_fit = std::min(cell.count + std::max(1U, cell.count / 10),
                           static_cast<std::uint32_t>(options_.max_points));
}

const MapPlane* PlaneMap::plane_at(const Eigen::Vector3f& point, const Sensor& sensor) const {
  if (!point.allFinite()) return nullptr;
  const VoxelKey key = voxel_key(voxel_of(cells_from_points_ * point, 1.0F));
  auto place = places_.find(key);
  if (place != places_.end() && is_behind(cells_[place->second], sensor))
    place = places_.find(key | kOtherSide);
  if (place == places_.end() || !cells_[place->second].has_plane) return nullptr;
  const Cell& cell = cells_[place->second];
  return is_behind(cell, sensor) ? nullptr : &cell.plane;
}

void PlaneMap::clear() {
  cells_.clear();
  places_.clear();
}

void PlaneMap::remove_far(const Eigen::Vector3f& center, float radius) {
  const Eigen::Vector3f center_in_cells = cells_from_points_ * center;
  const Eigen::Matrix3f points_from_cells =
      (options_.cell_size * grid_from_points(options_.axes).transpose()).cast<float>();
  std::erase_if(cells_, [&](const Cell& cell) {
    const Eigen::Vector3f middle =
        voxel_of_key(cell.key).cast<float>() + Eigen::Vector3f::Constant(0.5F);
    const Eigen::Vector3f away = points_from_cells * (middle - center_in_cells);
    return away.cwiseAbs().maxCoeff() > radius;
  });
  places_.clear();
  for (std::size_t i = 0; i < cells_.size(); ++i)
    places_.emplace(cells_[i].key, static_cast<std::uint32_t>(i));
}

std::vector<Eigen::Vector3f> PlaneMap::centers() const {
  std::vector<Eigen::Vector3f> centers;
  centers.reserve(cells_.size());
  for (const Cell& cell : cells_) {
    if (cell.count >= static_cast<std::uint32_t>(options_.min_points))
      centers.push_back(cell.plane.center);
  }
  return centers;
}

std::uint64_t PlaneMap::memory_bytes() const {
  return cells_.capacity() * sizeof(Cell) +
         places_.bucket_count() * (sizeof(std::pair<VoxelKey, std::uint32_t>) + sizeof(VoxelKey));
}

}  // namespace lidarena::map
