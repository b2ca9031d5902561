// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <tsl/robin_map.h>

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "lidarena/map/grid_axes.hpp"
#include "lidarena/map/voxel_key.hpp"

namespace lidarena::map {

/// The plane of a cell's points.
struct MapPlane {
  Eigen::Vector3f center = Eigen::Vector3f::Zero();  ///< m, mean of the points
  Eigen::Vector3f normal =
      Eigen::Vector3f::Zero();  ///< unit length; towards the sensor, if it was told
  float variance = 0.0F;        ///< m^2, mean squared distance of the points from the plane
  /// rad, bound on the error of the normal: four standard deviations by the noise of the points,
  /// and what is thicker than noise, which does not average out, such as a corner.
  float normal_error = 0.0F;
};

/// A map of planes: a hash table of cubic cells that each keep the number, the sum and the products
/// of their points' coordinates, from which the plane of the cell follows (the eigenvector of the
/// smallest eigenvalue of the points' covariance; as the normal distributions of P. Biber, W.
/// Strasser, "The Normal Distributions Transform", IROS 2003). No point is kept, so the memory
/// depends on the surface alone, and a lookup is one access to the table. A cell that has its
/// maximum number of points does not change any more: it stays where it was seen first, and a
/// sensor that passes again cannot displace it. If the sensor's place is told, a cell has two
/// sides: what is seen from behind the plane of the first is kept apart, as the other side of a
/// wall.
class PlaneMap {
 public:
  struct Options {
    double cell_size = 0.3;   ///< edge of a cell, m
    int max_points = 400;     ///< of a cell; later ones are left out
    int min_points = 6;       ///< of a plane
    double min_width = 0.04;  ///< m, of a plane: standard deviation of its points along the
                              ///< narrower direction; a line of points fits any plane through it
    double max_thickness = 0.06;  ///< m, of a plane: standard deviation of its points from it; what
                                  ///< is thicker is a cloud: dust, leaves
    double noise = 0.02;          ///< m, of a point: what is thicker is not flat
    GridAxes axes = GridAxes::kRotated;
  };

  using Sensor = std::optional<Eigen::Vector3f>;

  /// Throws InputError on options that are not positive.
  explicit PlaneMap(const Options& options);

  /// Adds points (m, map frame) and fits the planes of their cells anew, each as often as it has a
  /// tenth more points. Points that are not finite are left out. `sensor` (m): from where they
  /// were seen.
  void insert(std::span<const Eigen::Vector3f> points, const Sensor& sensor = std::nullopt);

  /// The plane of the cell that `point` (m) lies in, and of the side that is seen from `sensor`
  /// (m); null if it has none. Valid until the map changes.
  const MapPlane* plane_at(const Eigen::Vector3f& point, const Sensor& sensor = std::nullopt) const;

  void clear();
  /// Removes the cells whose points lie outside the box of half edge `radius` (m) around `center`.
  void remove_far(const Eigen::Vector3f& center, float radius);

  /// Mean of the points of each cell that has at least the minimum for a plane.
  std::vector<Eigen::Vector3f> centers() const;

  bool empty() const { return cells_.empty(); }
  std::size_t size() const { return cells_.size(); }  ///< cells
  std::uint64_t memory_bytes() const;

 private:
  struct Cell {
    VoxelKey key = 0;
    std::uint32_t count = 0;
    std::uint32_t next_fit = 0;  ///< number of points at which the plane is fitted again
    bool has_plane = false;
    // Coordinates in the grid's frame relative to the cell's center, in edges.
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    Eigen::Matrix<float, 6, 1> products = Eigen::Matrix<float, 6, 1>::Zero();
    MapPlane plane;
  };

  /// Index of the cell with this key, which is made if there is none.
  std::uint32_t cell_for(VoxelKey key);
  /// Whether the cell has a plane that turns its back on the sensor.
  static bool is_behind(const Cell& cell, const Sensor& sensor);
  void fit(Cell& cell, const Sensor& sensor) const;

  Options options_;
  Eigen::Matrix3f cells_from_points_;
  std::vector<Cell> cells_;
  tsl::robin_map<VoxelKey, std::uint32_t, VoxelKeyHash> places_;  ///< index in `cells_`
  std::vector<std::uint32_t> to_fit_;                             ///< of one insertion
};

}  // namespace lidarena::map
