// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/loop/place_descriptor.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lidarena::loop {
namespace {

constexpr float kDepth = 5.0F;  // m: heights are measured from this far below the place

/// One minus the mean cosine of the columns that are not empty in both, with `second` rotated by
/// `shift` sectors.
double distance_at(const PlaceDescriptor& first, const PlaceDescriptor& second, int shift) {
  float sum = 0.0F;
  int columns = 0;
  for (int k = 0; k < PlaceDescriptor::kSectors; ++k) {
    const auto a = first.heights.col((k + shift) % PlaceDescriptor::kSectors);
    const auto b = second.heights.col(k);
    const float norms = a.norm() * b.norm();
    if (norms <= 0.0F) continue;
    sum += a.dot(b) / norms;
    ++columns;
  }
  return columns == 0 ? 1.0 : 1.0 - static_cast<double>(sum / static_cast<float>(columns));
}

}  // namespace

PlaceDescriptor describe(std::span<const Eigen::Vector3f> points, double range) {
  PlaceDescriptor place;
  place.heights.setZero();
  for (const Eigen::Vector3f& p : points) {
    const double distance = std::hypot(double{p.x()}, double{p.y()});
    if (!(distance < range)) continue;
    const double turns = std::atan2(double{p.y()}, double{p.x()}) / (2.0 * std::numbers::pi) + 0.5;
    const int ring = static_cast<int>(distance / range * PlaceDescriptor::kRings);
    const int sector = static_cast<int>(turns * PlaceDescriptor::kSectors);
    float& cell = place.heights(std::min(ring, PlaceDescriptor::kRings - 1),
                                std::min(sector, PlaceDescriptor::kSectors - 1));
    cell = std::max(cell, p.z() + kDepth);
  }
  place.ring_means = place.heights.rowwise().mean();
  return place;
}

Resemblance compare(const PlaceDescriptor& first, const PlaceDescriptor& second) {
  Resemblance best;
  for (int shift = 0; shift < PlaceDescriptor::kSectors; ++shift) {
    const double distance = distance_at(first, second, shift);
    if (distance >= best.distance) continue;
    const double sectors =
        shift <= PlaceDescriptor::kSectors / 2 ? shift : shift - PlaceDescriptor::kSectors;
    best = {distance, sectors * 2.0 * std::numbers::pi / PlaceDescriptor::kSectors};
  }
  return best;
}

}  // namespace lidarena::loop
