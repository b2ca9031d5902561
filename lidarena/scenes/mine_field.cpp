// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/scenes/mine_field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lidarena::scenes {
namespace {

constexpr double kRounding = 0.4;     // m, radius of a drift's edges
constexpr double kCorner = 0.4;       // m, distance over which drifts are blended where they meet
constexpr double kPeak = 1.04;        // largest |GradientNoise|
constexpr double kDeep = 1.0;         // m, field value deep in rock
constexpr double kFloorShare = 0.25;  // of the noise, on the floor
constexpr double kFloorHeight = 0.6;  // m, above which the noise is whole
constexpr double kLattice = 1.0, kFineLattice = 0.3;  // m

double blended(double a, double b) {
  const double overlap = std::max(kCorner - std::abs(a - b), 0.0) / kCorner;
  return std::min(a, b) - 0.25 * kCorner * overlap * overlap;
}

/// Height of `p` above the drift's floor.
double height_in(const Drift& drift, const Eigen::Vector3d& p) {
  const Eigen::Vector2d axis = (drift.to - drift.from).head<2>();
  const double t = std::clamp((p - drift.from).head<2>().dot(axis) / axis.squaredNorm(), 0.0, 1.0);
  return p.z() - drift.from.z() - t * (drift.to.z() - drift.from.z());
}

/// Distance to a box with rounded edges, sheared to the slope of the floor.
double drift_distance(const Drift& drift, const Eigen::Vector3d& p) {
  const Eigen::Vector2d axis = (drift.to - drift.from).head<2>();
  const double length = axis.norm();
  const Eigen::Vector2d along = axis / length, place = (p - drift.from).head<2>();
  const double x = place.dot(along) - 0.5 * length;
  const double y = along.x() * place.y() - along.y() * place.x();
  const double z = height_in(drift, p) - 0.5 * drift.height;
  const Eigen::Vector3d outside(std::abs(x) - 0.5 * (length + drift.width) + kRounding,
                                std::abs(y) - 0.5 * drift.width + kRounding,
                                std::abs(z) - 0.5 * drift.height + kRounding);
  return outside.cwiseMax(0.0).norm() + std::min(outside.maxCoeff(), 0.0) - kRounding;
}

}  // namespace

MineField::MineField(const MinePlan& plan, const MineConfig& config, std::uint64_t seed)
    : config_(config),
      block_m_(SparseField::kBlock * config.voxel_size_m),
      large_(2 * seed + 1'000'003),
      small_(2 * seed + 1'000'004) {
  for (const Gallery& gallery : plan.galleries) drifts_.push_back(gallery.drift);
  drifts_.insert(drifts_.end(), plan.dead_ends.begin(), plan.dead_ends.end());
  drifts_.insert(drifts_.end(), plan.chambers.begin(), plan.chambers.end());
  index_drifts();
}

double MineField::noise_bound() const {
  return kPeak * (config_.roughness_1m_m + config_.roughness_03m_m);
}

Eigen::Vector3d MineField::block_center(const Eigen::Vector3i& block) const {
  return block_m_ * (block.cast<double>() + Eigen::Vector3d::Constant(0.5));
}

/// Lists for each block the drifts that can affect the field at a point of it near the surface.
void MineField::index_drifts() {
  const double half_diagonal = 0.5 * std::sqrt(3.0) * block_m_;
  const double reach = 3 * half_diagonal + noise_bound() + kCorner + 2 * config_.voxel_size_m;
  for (std::uint32_t i = 0; i < drifts_.size(); ++i) {
    const Drift& d = drifts_[i];
    const Eigen::Vector3d size(0.5 * d.width, 0.5 * d.width, d.height);
    const Eigen::Vector3d low = (d.from.cwiseMin(d.to) - size).array() - reach;
    const Eigen::Vector3d high = (d.from.cwiseMax(d.to) + size).array() + reach;
    const Eigen::Vector3i first = (low / block_m_).array().floor().cast<int>();
    const Eigen::Vector3i last = (high / block_m_).array().floor().cast<int>();
    Eigen::Vector3i b;
    for (b.z() = first.z(); b.z() <= last.z(); ++b.z()) {
      for (b.y() = first.y(); b.y() <= last.y(); ++b.y()) {
        for (b.x() = first.x(); b.x() <= last.x(); ++b.x()) {
          if (drift_distance(d, block_center(b)) > reach) continue;
          Near& near = near_[SparseField::key(b)];
          if (near.empty()) blocks_.push_back(b);
          near.push_back(i);
        }
      }
    }
  }
}

MineField::Space MineField::space_at(const Near& near, const Eigen::Vector3d& p) const {
  double united = std::numeric_limits<double>::infinity();
  double nearest = united;
  const Drift* in = nullptr;
  for (const std::uint32_t i : near) {
    const double distance = drift_distance(drifts_[i], p);
    united = in == nullptr ? distance : blended(united, distance);
    if (distance < nearest) {
      nearest = distance;
      in = &drifts_[i];
    }
  }
  return {united, in == nullptr ? 0.0 : height_in(*in, p)};
}

double MineField::noise(const Eigen::Vector3d& p, double above_floor) const {
  const double rise = std::clamp(above_floor / kFloorHeight, 0.0, 1.0);
  const double share = kFloorShare + (1.0 - kFloorShare) * rise * rise * (3.0 - 2.0 * rise);
  return share * (config_.roughness_1m_m * large_(p / kLattice) +
                  config_.roughness_03m_m * small_(p / kFineLattice));
}

double MineField::operator()(const Eigen::Vector3d& p) const {
  const Eigen::Vector3i block = (p / block_m_).array().floor().cast<int>();
  const auto near = near_.find(SparseField::key(block));
  if (near == near_.end()) return kDeep;
  const Space space = space_at(near->second, p);
  return space.distance + noise(p, space.above_floor);
}

SparseField MineField::sample() const {
  SparseField field(config_.voxel_size_m);
  const double half_diagonal = 0.5 * std::sqrt(3.0) * block_m_;
  const double band = noise_bound() + 2 * config_.voxel_size_m;
  for (const Eigen::Vector3i& block : blocks_) {
    const Near& near = near_.at(SparseField::key(block));
    if (std::abs(space_at(near, block_center(block)).distance) > half_diagonal + band) continue;
    SparseField::Values& values = field.add_block(block);
    Eigen::Vector3i p;
    for (p.z() = 0; p.z() < SparseField::kBlock; ++p.z()) {
      for (p.y() = 0; p.y() < SparseField::kBlock; ++p.y()) {
        for (p.x() = 0; p.x() < SparseField::kBlock; ++p.x()) {
          const Eigen::Vector3d position = field.position(SparseField::kBlock * block + p);
          const Space space = space_at(near, position);
          double value = space.distance;
          if (std::abs(value) < band) value += noise(position, space.above_floor);
          values[SparseField::index_in_block(p)] = static_cast<float>(value);
        }
      }
    }
  }
  return field;
}

}  // namespace lidarena::scenes
