// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/scenes/cave_field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lidarena::scenes {
namespace {

constexpr double kBlend = 1.0;        // m, distance over which tunnels are blended at a junction
constexpr double kNoisePeak = 1.04;   // largest |GradientNoise|
constexpr double kFar = 1.0;          // m, field value deep in rock
constexpr double kLargeScale = 2.0;   // m, lattice step of the noise, as are the next two
constexpr double kMediumScale = 0.3;  // m
constexpr double kSmallScale = 0.05;  // m

/// The minimum of a and b with the corner rounded over `kBlend` (quadratic, C1).
double smooth_min(double a, double b) {
  const double overlap = std::max(kBlend - std::abs(a - b), 0.0) / kBlend;
  return std::min(a, b) - 0.25 * kBlend * overlap * overlap;
}

}  // namespace

CaveField::CaveField(const CaveGraph& graph, const CaveConfig& config, std::uint64_t seed)
    : config_(config),
      block_m_(SparseField::kBlock * config.voxel_size_m),
      large_(3 * seed),
      medium_(3 * seed + 1),
      small_(3 * seed + 2) {
  for (std::size_t t = 0; t < graph.tunnels.size(); ++t) {
    const Tunnel& tunnel = graph.tunnels[t];
    for (std::size_t i = 1; i < tunnel.points.size(); ++i) {
      segments_.push_back(
          {tunnel.points[i - 1], tunnel.points[i], tunnel.radii[i - 1], tunnel.radii[i], t});
    }
  }
  index_segments();
}

double CaveField::noise_bound() const {
  return kNoisePeak * (config_.roughness_2m_m + config_.roughness_03m_m + config_.roughness_005m_m);
}

Eigen::Vector3d CaveField::block_center(const Eigen::Vector3i& block) const {
  return block_m_ * (block.cast<double>() + Eigen::Vector3d::Constant(0.5));
}

double CaveField::segment_distance(const Segment& s, const Eigen::Vector3d& p) const {
  const Eigen::Vector3d ab = s.b - s.a;
  const double t = std::clamp((p - s.a).dot(ab) / ab.squaredNorm(), 0.0, 1.0);
  return (p - s.a - t * ab).norm() - (s.radius_a + t * (s.radius_b - s.radius_a));
}

/// Lists for each block the segments that can affect the field at a point of it near the surface.
void CaveField::index_segments() {
  const double half_diagonal = 0.5 * std::sqrt(3.0) * block_m_;
  // A segment affects the field at p when its distance is within kBlend of the minimum. The minimum
  // is at most the noise bound plus two grid steps plus the diameter of the block.
  const double reach = 3 * half_diagonal + noise_bound() + kBlend + 2 * config_.voxel_size_m;
  for (std::uint32_t i = 0; i < segments_.size(); ++i) {
    const Segment& s = segments_[i];
    const double outer = reach + std::max(s.radius_a, s.radius_b);
    const Eigen::Vector3d low = (s.a.cwiseMin(s.b).array() - outer) / block_m_;
    const Eigen::Vector3d high = (s.a.cwiseMax(s.b).array() + outer) / block_m_;
    Eigen::Vector3i b;
    for (b.z() = int(std::floor(low.z())); b.z() <= high.z(); ++b.z()) {
      for (b.y() = int(std::floor(low.y())); b.y() <= high.y(); ++b.y()) {
        for (b.x() = int(std::floor(low.x())); b.x() <= high.x(); ++b.x()) {
          if (segment_distance(s, block_center(b)) > reach) continue;
          Near& near = near_[SparseField::key(b)];
          if (near.empty()) blocks_.push_back(b);
          near.push_back(i);
        }
      }
    }
  }
}

double CaveField::tunnel_distance(const Near& near, const Eigen::Vector3d& p) const {
  double united = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < near.size();) {
    const std::size_t tunnel = segments_[near[i]].tunnel;
    double distance = std::numeric_limits<double>::infinity();
    for (; i < near.size() && segments_[near[i]].tunnel == tunnel; ++i) {
      distance = std::min(distance, segment_distance(segments_[near[i]], p));
    }
    united = std::isinf(united) ? distance : smooth_min(united, distance);
  }
  return united;
}

double CaveField::noise(const Eigen::Vector3d& p) const {
  return config_.roughness_2m_m * large_(p / kLargeScale) +
         config_.roughness_03m_m * medium_(p / kMediumScale) +
         config_.roughness_005m_m * small_(p / kSmallScale);
}

double CaveField::operator()(const Eigen::Vector3d& p) const {
  const Eigen::Vector3i block = (p / block_m_).array().floor().cast<int>();
  const auto near = near_.find(SparseField::key(block));
  return near == near_.end() ? kFar : tunnel_distance(near->second, p) + noise(p);
}

bool CaveField::may_hold_surface(const Eigen::Vector3i& block, const Near& near) const {
  const double half_diagonal = 0.5 * std::sqrt(3.0) * block_m_;
  return std::abs(tunnel_distance(near, block_center(block))) <=
         half_diagonal + noise_bound() + 2 * config_.voxel_size_m;
}

SparseField CaveField::sample() const {
  SparseField field(config_.voxel_size_m);
  const double band = noise_bound() + 2 * config_.voxel_size_m;
  for (const Eigen::Vector3i& block : blocks_) {
    const Near& near = near_.at(SparseField::key(block));
    if (!may_hold_surface(block, near)) continue;
    SparseField::Values& values = field.add_block(block);
    Eigen::Vector3i p;
    for (p.z() = 0; p.z() < SparseField::kBlock; ++p.z()) {
      for (p.y() = 0; p.y() < SparseField::kBlock; ++p.y()) {
        for (p.x() = 0; p.x() < SparseField::kBlock; ++p.x()) {
          const Eigen::Vector3d position = field.position(SparseField::kBlock * block + p);
          double value = tunnel_distance(near, position);
          if (std::abs(value) < band)
            value += noise(position);  // elsewhere the noise cannot change the sign
          values[SparseField::index_in_block(p)] = static_cast<float>(value);
        }
      }
    }
  }
  return field;
}

void project_onto_surface(world::TriangleMesh& mesh,
                          const std::function<double(const Eigen::Vector3d&)>& field, double step) {
  const double h = 0.5 * step;
  for (Eigen::Vector3d& p : mesh.vertices) {
    double value = field(p);
    Eigen::Vector3d gradient;
    for (int axis = 0; axis < 3; ++axis) {
      gradient[axis] = (field(p + h * Eigen::Vector3d::Unit(axis)) - value) / h;
    }
    for (int iteration = 0; iteration < 2; ++iteration) {
      Eigen::Vector3d move = -value / std::max(gradient.squaredNorm(), 0.25) * gradient;
      if (move.norm() > h) move *= h / move.norm();
      p += move;
      if (iteration == 0) value = field(p);
    }
  }
}

}  // namespace lidarena::scenes
