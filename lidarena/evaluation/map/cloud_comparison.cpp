// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/evaluation/map/cloud_comparison.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <numeric>

#include "lidarena/base/error.hpp"
#include "lidarena/map/kd_tree.hpp"

namespace lidarena::evaluation {
namespace {

constexpr std::size_t kGrain = 64;  // points of a task

std::vector<Eigen::Vector3f> finite_points(std::span<const Eigen::Vector3f> points,
                                           const std::string& name) {
  std::vector<Eigen::Vector3f> finite;
  std::ranges::copy_if(points, std::back_inserter(finite),
                       [](const Eigen::Vector3f& p) { return p.allFinite(); });
  if (finite.empty()) throw InputError(name, "a cloud has no point", "check its file");
  return finite;
}

/// Distance of each of `points` from the nearest point of `other`, m.
std::vector<double> distances(const std::vector<Eigen::Vector3f>& points,
                              const std::vector<Eigen::Vector3f>& other, const Parallel& parallel) {
  map::KdTree tree;
  tree.build(other);
  std::vector<double> found(points.size());
  parallel.for_each(points.size(), kGrain, [&](std::size_t i) {
    std::array<map::Neighbor, 1> nearest{};
    tree.nearest(points[i], nearest);
    found[i] = (nearest[0].point - points[i]).cast<double>().norm();
  });
  return found;
}

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double share_within(const std::vector<double>& values, double limit) {
  const auto within = std::ranges::count_if(values, [&](double v) { return v <= limit; });
  return static_cast<double>(within) / static_cast<double>(values.size());
}

double f_score(const std::vector<double>& of_map, const std::vector<double>& of_reference,
               double limit) {
  const double precision = share_within(of_map, limit);
  const double recall = share_within(of_reference, limit);
  return precision + recall > 0.0 ? 2.0 * precision * recall / (precision + recall) : 0.0;
}

/// Entropy and smallest eigenvalue of a neighborhood; NaN with too few points.
struct Neighborhood {
  double entropy = std::numeric_limits<double>::quiet_NaN();
  double thickness2 = 0.0;
};

Neighborhood neighborhood_of(const Eigen::Vector3f& center, const map::KdTree& tree) {
  constexpr std::size_t kMin = 15, kMax = 1000;
  constexpr float kRadius = 0.3F;      // m
  constexpr double kRounding = 1e-12;  // m^2; a plane without noise has no finite entropy
  std::vector<map::Neighbor> near(kMax);
  near.resize(tree.nearest(center, near, kRadius));
  if (near.size() < kMin) return {};
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  for (const map::Neighbor& neighbor : near) {
    const Eigen::Vector3d p = (neighbor.point - center).cast<double>();
    sum += p;
    squares += p * p.transpose();
  }
  const auto n = static_cast<double>(near.size());
  const Eigen::Matrix3d covariance = squares / n - (sum / n) * (sum / n).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance, Eigen::EigenvaluesOnly);
  const Eigen::Vector3d values = solver.eigenvalues().cwiseMax(kRounding);
  const double log_det = values.array().log().sum();
  return {0.5 * (3.0 * std::log(2.0 * std::numbers::pi * std::numbers::e) + log_det), values[0]};
}

}  // namespace

CloudComparison compare_clouds(std::span<const Eigen::Vector3f> map,
                               std::span<const Eigen::Vector3f> reference, const std::string& name,
                               const Parallel& parallel) {
  const auto a = finite_points(map, name);
  const auto b = finite_points(reference, name);
  const std::vector<double> of_map = distances(a, b, parallel);
  const std::vector<double> of_reference = distances(b, a, parallel);
  CloudComparison result;
  result.accuracy_m = mean(of_map);
  result.completeness_m = mean(of_reference);
  result.chamfer_m = 0.5 * (result.accuracy_m + result.completeness_m);
  result.f_score_5cm = f_score(of_map, of_reference, 0.05);
  result.f_score_10cm = f_score(of_map, of_reference, 0.10);
  result.map_points = a.size();
  result.reference_points = b.size();
  return result;
}

MapAgreement map_agreement(std::span<const Eigen::Vector3f> map, const Parallel& parallel) {
  constexpr std::size_t kMost = 20'000;
  const auto points = finite_points(map, "map");
  map::KdTree tree;
  tree.build(points);
  const std::size_t step = (points.size() + kMost - 1) / kMost;
  std::vector<Neighborhood> all((points.size() + step - 1) / step);
  parallel.for_each(all.size(), kGrain,
                    [&](std::size_t i) { all[i] = neighborhood_of(points[i * step], tree); });
  std::erase_if(all, [](const Neighborhood& n) { return std::isnan(n.entropy); });
  MapAgreement agreement;
  agreement.neighborhoods = all.size();
  if (all.empty()) return agreement;
  for (const Neighborhood& n : all)
    agreement.mean_map_entropy += n.entropy / static_cast<double>(all.size());
  std::ranges::sort(all, {}, &Neighborhood::thickness2);
  all.resize((all.size() + 1) / 2);
  double sum = 0.0;
  for (const Neighborhood& n : all) sum += n.thickness2;
  agreement.plane_thickness_m = std::sqrt(sum / static_cast<double>(all.size()));
  return agreement;
}

}  // namespace lidarena::evaluation
