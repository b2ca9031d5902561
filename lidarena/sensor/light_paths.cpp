// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/light_paths.hpp"

#include <span>

namespace lidarena::sensor {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double kLeastShare = 1e-3;  // of the light; less is left out
constexpr double kOffSurface = 1e-3;  // m; a ray that leaves a surface begins off it

/// A ray with its hit, on its way.
struct Leg {
  world::Ray ray;
  world::Hit hit;
  double before = 0.0;  ///< m, length of the path before the ray
  double share = 1.0;
  bool mirrored = false;
  int bounces = 0;  ///< that are left
};

double square(double x) { return x * x; }

double cosine_of(const Leg& leg) {
  return -static_cast<double>(leg.hit.normal.dot(leg.ray.direction));
}

/// The leg that continues in `direction`; its hit is not valid if there is none.
Leg next_leg(const world::Surfaces& world, Time t, const Leg& leg, const Vector3f& direction,
             double share, bool mirrored, double max_length) {
  const double range = static_cast<double>(leg.hit.range);
  const Vector3d at = leg.ray.origin + range * leg.ray.direction.cast<double>();
  Leg next;
  next.ray = {at + kOffSurface * direction.cast<double>(), direction};
  next.before = leg.before + range + kOffSurface;
  next.share = leg.share * share;
  next.mirrored = leg.mirrored || mirrored;
  next.bounces = leg.bounces - 1;
  if (next.share < kLeastShare || next.before >= max_length) return next;
  world.cast_at(t, std::span(&next.ray, 1), max_length - next.before, std::span(&next.hit, 1));
  return next;
}

}  // namespace

double entering_share(const world::Material& material, double cos_incidence) {
  const double normal = world::mirrored_share(material, 1.0);
  if (normal == 0.0 || normal == 1.0) return 1.0;
  return (1.0 - world::mirrored_share(material, cos_incidence)) / (1.0 - normal);
}

void follow_light(const world::Surfaces& world, Time t, const world::Ray& ray,
                  const world::Hit& first, int bounces, double max_length,
                  std::vector<PathEnd>& ends) {
  std::vector<Leg> legs;
  const auto add = [&](const Leg& leg) {
    if (!leg.hit.valid()) return;
    const double length = leg.before + static_cast<double>(leg.hit.range);
    ends.push_back({length, leg.share, leg.mirrored, cosine_of(leg), leg.hit});
    if (leg.bounces > 0) legs.push_back(leg);
  };
  legs.push_back({ray, first, 0.0, 1.0, false, bounces});
  while (!legs.empty()) {
    const Leg leg = legs.back();
    legs.pop_back();
    const world::Material& material = world.material(leg.hit.triangle);
    const double cosine = cosine_of(leg);
    const double passed = material.transmission * entering_share(material, cosine);
    const double mirrored = world::mirrored_share(material, cosine);
    const Vector3f image = leg.ray.direction + 2.0F * static_cast<float>(cosine) * leg.hit.normal;
    add(next_leg(world, t, leg, leg.ray.direction, square(passed), false, max_length));
    add(next_leg(world, t, leg, image, square(mirrored), true, max_length));
  }
}

}  // namespace lidarena::sensor
