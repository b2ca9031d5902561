// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lidarena/base/pose.hpp"
#include "lidarena/results/summary.hpp"

/// Scores of one map against the mesh. docs/metrics.md defines each by its `definition`. A figure
/// that does not exist is empty here and null in JSON, never zero or NaN.
namespace lidarena::results {

/// Counts of the distances up to 20 cm.
struct DistanceHistogram {
  static constexpr const char* kTitle = "DistanceHistogram";
  static constexpr double kBin_m = 0.01;  ///< width of a bin
  static constexpr std::size_t kBins = 20;
  double bin_m = kBin_m;
  std::vector<std::uint64_t> counts = std::vector<std::uint64_t>(kBins, 0);
  std::uint64_t beyond = 0;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("bin_m", self.bin_m, "m", "width of a bin; the first begins at zero");
    v("counts", self.counts, "", "points");
    v("beyond", self.beyond, "", "points farther than the last bin");
  }
};

/// Distances of the occupied voxels of a map, each of which counts once.
struct VoxelError {
  static constexpr double kVoxel_m = 0.05;
  std::string definition = "map_error_voxels[5cm,rms-by-voxel,20cm]";
  double voxel_m = kVoxel_m;
  std::size_t voxels = 0;
  /// Root mean square of the point distances in each voxel. The RMSE of these values is the RMSE of
  /// the points weighted by 1 / (points in the voxel).
  SummaryInMeters rms_m;
  double outliers_percent = 0.0;
  bool empty() const { return voxels == 0; }

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("definition", self.definition, "", "id in docs/metrics.md");
    v("voxel_m", self.voxel_m, "m", "edge of a voxel");
    v("voxels", self.voxels, "", "occupied ones");
    v("distance", self.rms_m, "", "RMS of the distances in each voxel");
    v("outliers_percent", self.outliers_percent, "%",
      "mean over voxels of the share of points beyond 20 cm");
  }
};

/// Counts of signed distances from -20 to 20 cm.
struct SignedHistogram {
  static constexpr double kRange_m = 0.20;
  static constexpr double kBin_m = 0.01;
  static constexpr std::size_t kBins = 40;
  double from_m = -kRange_m, bin_m = kBin_m;
  std::vector<std::uint64_t> counts = std::vector<std::uint64_t>(kBins, 0);
  std::size_t below = 0, above = 0;  ///< beyond -20 and +20 cm

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("from_m", self.from_m, "m", "start of the first bin");
    v("bin_m", self.bin_m, "m", "width of a bin");
    v("counts", self.counts, "", "points");
    v("below", self.below, "", "points before the first bin");
    v("above", self.above, "", "points after the last bin");
  }
};

/// Signed distance: positive in free space, in front of the surface as the sensor saw it; negative
/// behind it. A range bias shifts the mean, a double wall makes a second peak.
struct SignedDistance {
  /// A point whose direction from its nearest triangle is more than 60 degrees off the normal is
  /// beside an edge; that triangle does not determine on which side it lies.
  static constexpr double kMinCosine = 0.5;
  std::string definition = "map_error_signed[free-side-of-rays,within60deg]";
  std::size_t points = 0;   ///< number of points with a sign
  std::size_t without = 0;  ///< beside an edge, or nearest to a triangle whose free side is unknown
  double mean_m = 0.0, median_m = 0.0, p5_m = 0.0, p95_m = 0.0;
  double behind_percent = 0.0;  ///< share below zero
  SignedHistogram histogram;
  bool empty() const { return points == 0; }

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("definition", self.definition, "", "id in docs/metrics.md");
    v("points", self.points, "", "those with a sign");
    v("points_without_sign", self.without, "", "beside an edge, or the free side is unknown");
    v("mean_m", self.mean_m, "m", "");
    v("median_m", self.median_m, "m", "");
    v("p5_m", self.p5_m, "m", "5th percentile");
    v("p95_m", self.p95_m, "m", "95th percentile");
    v("behind_percent", self.behind_percent, "%", "share below zero");
    v("histogram", self.histogram, "", "");
  }
};

/// Double walls: patches of the surface whose points lie on two sheets.
struct Ghosting {
  static constexpr double kPatch_m = 0.20;  ///< edge of the cubes that divide the surface
  static constexpr double kReach_m = 0.50;  ///< points farther from the mesh belong to no patch
  static constexpr std::size_t kMinPoints = 50;  ///< minimum for a patch to be judged
  /// Criteria for two sheets. The patch is split where the variance between the parts is largest
  /// (Otsu 1979). The smaller part holds at least 5 % of the points (and 5 points). Ashman's D
  /// (Ashman, Bird, Zepf 1994) of the parts is above 4 (a normal distribution split this way has
  /// 2.65, a uniform one 3.46). The middle third between their means is a valley: it has less than
  /// a quarter of the smaller part's points.
  static constexpr double kMinShare = 0.05;
  static constexpr double kMinInPart = 5.0;
  static constexpr double kMinAshmanD = 4.0;
  static constexpr double kValley = 0.25;
  static constexpr double kMinMeanDistance_m = 0.02;  ///< of the means; less is within sensor noise
  std::string definition = "ghosting[20cm-patches,otsu,ashman4,valley]";
  double patch_m = kPatch_m;
  std::size_t patches = 0;      ///< number of judged patches
  SummaryInMeters thickness_m;  ///< P95 - P5 of the heights above the surface, by patch
  std::size_t double_patches = 0;
  double double_percent = 0.0;                ///< share of double patches
  std::optional<double> median_separation_m;  ///< between the sheets' means, over double patches
  bool empty() const { return patches == 0; }

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("definition", self.definition, "", "id in docs/metrics.md");
    v("patch_m", self.patch_m, "m", "edge of the cubes that divide the surface");
    v("patches", self.patches, "", "judged ones");
    v("thickness", self.thickness_m, "", "P95 - P5 of the heights above the surface, by patch");
    v("double_patches", self.double_patches, "", "patches with two sheets");
    v("double_percent", self.double_percent, "%", "their share");
    v("median_separation_m", self.median_separation_m, "m", "between the means of two sheets");
  }
};

/// Distance of each point from the true hit of its own ray, not from the nearest surface; the
/// distance to the mesh is a lower bound of it. All in m.
struct IdentityError {
  std::string definition = "identity_error[own-true-hit]";
  SummaryInMeters distance_m;
  SummaryInMeters normal_m;      ///< magnitude of its component along the surface's normal
  SummaryInMeters tangential_m;  ///< its component along the surface
  bool empty() const { return distance_m.empty(); }

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("definition", self.definition, "", "id in docs/metrics.md");
    v("distance", self.distance_m, "", "");
    v("normal", self.normal_m, "", "component along the surface's normal");
    v("tangential", self.tangential_m, "", "component along the surface");
  }
};

/// The scored points of a map whose returns are of one class.
struct ClassOfPoints {
  std::size_t points = 0;
  double share_percent = 0.0;                      ///< of the points whose class is known
  std::optional<double> rmse_m, outliers_percent;  ///< empty without points

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("points", self.points, "", "");
    v("share_percent", self.share_percent, "%", "of the points whose class is known");
    v("rmse_m", self.rmse_m, "m", "root mean square of the distances to the mesh");
    v("outliers_percent", self.outliers_percent, "%", "of the class, beyond 20 cm");
  }
};

/// What the returns behind the scored points are of.
struct PointClasses {
  std::string definition = "point_classes[by-true-hit,20cm]";
  std::optional<std::string> refused;
  std::size_t points = 0;  ///< scored ones whose class is known
  std::optional<ClassOfPoints> world, mover, air, ghost;
  bool empty() const { return points == 0 && !refused; }

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("definition", self.definition, "", "id in docs/metrics.md");
    v("refused", self.refused, "", "why there is no figure");
    v("points", self.points, "", "scored ones whose class is known");
    v("world", self.world, "", "of the mesh that the map is scored against");
    v("mover", self.mover, "", "of bodies that move, which the mesh does not have");
    v("air", self.air, "", "of fog, dust or rain");
    v("ghost", self.ghost, "", "mirror images, and halos of retroreflectors");
  }
};

/// Precision, recall and F-score within one distance.
struct CompletenessRow {
  double within_m = 0.0;
  double precision_percent = 0.0;  ///< map points within this distance of the mesh
  double recall_percent = 0.0;     ///< seen samples with a map point within this
  double f_score_percent = 0.0;    ///< 2 P R / (P + R)

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("within_m", self.within_m, "m", "");
    v("precision_percent", self.precision_percent, "%", "map points this near to the mesh");
    v("recall_percent", self.recall_percent, "%",
      "samples of the seen surface this near to the map");
    v("f_score_percent", self.f_score_percent, "%", "2 P R / (P + R)");
  }
};

/// Precision, recall and F-score of the map with respect to the seen surface.
struct Completeness {
  static constexpr std::array<double, 4> kWithin_m{0.02, 0.05, 0.10, 0.20};
  /// One sample per 10 cm^2. Distances from samples to the map are exact, so the density causes no
  /// bias. It determines the standard error of a share p, sqrt(p (1 - p) / samples): at most 0.16 %
  /// for 100 m^2.
  static constexpr double kSamplesPerSquareMeter = 1000.0;
  std::string definition = "completeness[seen2cm,stratified-by-area]";
  std::size_t samples = 0;
  double samples_per_m2 = kSamplesPerSquareMeter;
  double seen_m2 = 0.0;
  std::vector<CompletenessRow> rows;  ///< of kWithin_m
  bool empty() const { return samples == 0; }
  /// The row within `distance_m`, one of kWithin_m; null when empty.
  const CompletenessRow* within(double distance_m) const;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("definition", self.definition, "", "id in docs/metrics.md");
    v("samples", self.samples, "", "of the surface that the flight's rays hit");
    v("samples_per_m2", self.samples_per_m2, "1/m2", "");
    v("seen_m2", self.seen_m2, "m2", "area of the seen surface");
    v("rows", self.rows, "", "");
  }
};

/// Distances to the vertices of the subdivided mesh, as other evaluations define them.
struct VertexDistance {
  static constexpr double kEdge_m = 0.05;
  static constexpr std::uint64_t kMaxVertices = 20'000'000;  ///< needs about 1.4 GB temporarily
  std::string definition = "map_error_vertices[point-vertex,regular-subdivision,20cm]";
  double edge_m = kEdge_m;  ///< maximum edge length of the subdivided mesh
  std::uint64_t vertices = 0;
  std::optional<std::string> refused;
  std::size_t points = 0;
  std::optional<double> rmse_m, rmse_inliers_m, median_m, outliers_percent;
  bool empty() const { return points == 0 && !refused; }

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("definition", self.definition, "", "id in docs/metrics.md");
    v("edge_m", self.edge_m, "m", "maximum edge of the subdivided mesh");
    v("vertices", self.vertices, "", "");
    v("refused", self.refused, "", "why there is no figure");
    v("points", self.points, "", "");
    v("rmse_m", self.rmse_m, "m", "root mean square");
    v("rmse_inliers_m", self.rmse_inliers_m, "m", "of the points within 20 cm");
    v("median_m", self.median_m, "m", "");
    v("outliers_percent", self.outliers_percent, "%", "beyond 20 cm");
  }
};

/// How the map was fitted to the mesh.
struct MeshFit {
  static constexpr int kStarts = 5;  ///< starting poses: the given one and four around it
  std::string definition = "alignment_robust[trimmed-icp,point-plane,10cm-voxels]";
  std::size_t points = 0;  ///< fitted points, at most one per 10 cm voxel of the map
  int iterations = 0;
  double inliers_percent = 0.0;  ///< of the fitted points, within 20 cm after alignment
  int starts = kStarts;
  int starts_agreeing = 0;
  /// Eigenvalues of the Gauss-Newton Hessian per point, in ascending order, scaled so that a unit
  /// step moves the points by 1 m RMS: the mean square that such a step adds to the distances, 0
  /// (not observable) to 1. A closed room has 0.1 and more in all directions; an endless corridor
  /// has one zero.
  std::array<double, 6> eigenvalues{};
  /// Unobservable directions, in which the start is kept: "translation along (1.00, 0.00, 0.00)",
  /// "rotation about (...)", mesh frame.
  std::vector<std::string> frozen;
  double moved_m = 0.0;     ///< translation of the points' centroid from the start
  double turned_rad = 0.0;  ///< rotation from the start
  std::optional<double> turned_from_first_pose_rad;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("definition", self.definition, "", "id in docs/metrics.md");
    v("points", self.points, "", "fitted ones");
    v("iterations", self.iterations, "", "");
    v("inliers_percent", self.inliers_percent, "%", "of the fitted points, within 20 cm");
    v("starts", self.starts, "", "starting poses");
    v("starts_agreeing", self.starts_agreeing, "", "");
    v("eigenvalues", self.eigenvalues, "", "of the scaled Hessian, 0 (not observable) to 1");
    v("frozen", self.frozen, "", "unobservable directions, in which the start is kept");
    v("moved_m", self.moved_m, "m", "from the start");
    v("turned_rad", self.turned_rad, "rad", "from the start");
    v("turned_from_first_pose_rad", self.turned_from_first_pose_rad, "rad", "");
  }
};

/// Distances of a map's points to the mesh.
struct MapError {
  static constexpr double kOutlier_m = 0.20;  ///< the paper's threshold
  std::string definition = "map_error[point-triangle,all-points,20cm]";
  std::size_t points = 0;      ///< number of scored points
  std::size_t map_points = 0;  ///< of the whole map, of which large ones are sampled; 0 = not known
  std::size_t invalid = 0;     ///< NaN or infinite points, left out
  SummaryInMeters distance_m;
  std::size_t inliers = 0;  ///< points within 20 cm
  std::optional<double> rmse_inliers_m, outliers_percent;
  double outlier_beyond_m = kOutlier_m;
  std::vector<double> cdf_percent;  ///< at the upper edges of the histogram's bins
  DistanceHistogram histogram;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("definition", self.definition, "", "id in docs/metrics.md");
    v("points", self.points, "", "scored ones");
    v("map_points", self.map_points, "", "of the whole map: fewer are scored if it is large");
    v("invalid_points", self.invalid, "", "not finite, left out");
    v("distance", self.distance_m, "", "point to mesh");
    v("inliers", self.inliers, "", "points within 20 cm");
    v("rmse_inliers_m", self.rmse_inliers_m, "m", "of the points within 20 cm");
    v("outliers_percent", self.outliers_percent, "%", "beyond 20 cm");
    v("outlier_beyond_m", self.outlier_beyond_m, "m", "");
    v("cdf_percent", self.cdf_percent, "%", "points up to the upper edge of each bin");
    v("histogram", self.histogram, "", "");
  }
};

/// Scores of a map in one alignment.
struct MapScores : MapError {
  std::optional<std::string> refused;
  std::optional<Pose> mesh_from_map;
  VoxelError per_voxel;
  Ghosting ghosting;
  IdentityError identity;
  PointClasses classes;
  SignedDistance signed_distance;
  Completeness completeness;
  VertexDistance point_vertex;
  std::optional<MeshFit> alignment;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    MapError::visit(self, v);
    v("refused", self.refused, "", "why the alignment is not determined");
    v("mesh_from_map_m_quaternion", self.mesh_from_map, "m", "x y z qx qy qz qw");
    v("per_voxel", self.per_voxel, "", "each occupied voxel counts once");
    v("ghosting", self.ghosting, "", "double walls");
    v("identity", self.identity, "", "to the true hit of each point's own ray");
    v("classes", self.classes, "", "what the points' returns are of");
    v("signed", self.signed_distance, "", "in front of and behind the surface");
    v("completeness", self.completeness, "", "of the surface that the flight's rays hit");
    v("point_vertex", self.point_vertex, "", "to the vertices of the subdivided mesh");
    v("alignment", self.alignment, "", "the fit of the robust alignment");
  }
};

struct MapMetrics {
  MapScores first_pose, se3, robust;

  template <class Self, class V>
  static void visit(Self& self, V&& v) {
    v("first_pose", self.first_pose, "", "aligned by the first common pose");
    v("se3", self.se3, "", "aligned by least squares over all positions");
    v("robust", self.robust, "", "aligned by fitting the map to the mesh");
  }
};

}  // namespace lidarena::results
