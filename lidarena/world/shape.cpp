// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/world/shape.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lidarena/world/bvh.hpp"

namespace lidarena::world {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The roots of a t^2 + 2 b t + c, the smaller first; both NaN when there is no real root.
struct Roots {
  double first, second;
  Roots(double a, double b, double c) {
    const double root = std::sqrt(b * b - a * c);
    const double q = -(b + std::copysign(root, b));  // avoids cancellation
    const double one = q / a, other = q == 0.0 ? 0.0 : c / q;
    first = std::min(one, other);
    second = std::max(one, other);
  }
};

class Sphere final : public Shape {
 public:
  explicit Sphere(double radius) : radius_(radius) {}
  AlignedBox3d bounds() const override {
    return {Vector3d::Constant(-radius_), Vector3d::Constant(radius_)};
  }
  bool intersect(const Ray& ray, double far, Intersection& intersection) const override {
    const Vector3d direction = ray.direction.cast<double>();
    const Roots roots(direction.squaredNorm(), direction.dot(ray.origin),
                      ray.origin.squaredNorm() - radius_ * radius_);
    for (const double range : {roots.first, roots.second}) {
      if (!(range >= 0.0 && range <= far)) continue;
      intersection = {range, (ray.origin + range * direction) / radius_, 0};
      return true;
    }
    return false;
  }

 private:
  double radius_;
};

class Cylinder final : public Shape {
 public:
  Cylinder(double radius, double length) : radius_(radius), half_(0.5 * length) {}
  AlignedBox3d bounds() const override {
    const Vector3d corner(radius_, radius_, half_);
    return {-corner, corner};
  }
  bool intersect(const Ray& ray, double far, Intersection& intersection) const override {
    const Vector3d direction = ray.direction.cast<double>();
    double nearest = far;
    bool met = false;
    const auto take = [&](double range, const Vector3d& normal) {
      if (!(range >= 0.0 && range <= nearest)) return;
      nearest = range;
      intersection = {range, normal, 0};
      met = true;
    };
    const auto d = direction.head<2>();
    const auto o = ray.origin.head<2>();
    if (d.squaredNorm() > 0.0) {
      const Roots roots(d.squaredNorm(), d.dot(o), o.squaredNorm() - radius_ * radius_);
      for (const double range : {roots.first, roots.second}) {
        const Vector3d point = ray.origin + range * direction;
        if (std::abs(point.z()) <= half_) {
          take(range, {point.x() / radius_, point.y() / radius_, 0.0});
        }
      }
    }
    if (direction.z() != 0.0) {
      for (const double end : {-half_, half_}) {
        const double range = (end - ray.origin.z()) / direction.z();
        const auto point = o + range * d;
        if (point.squaredNorm() <= radius_ * radius_) take(range, Vector3d::UnitZ());
      }
    }
    return met;
  }

 private:
  double radius_, half_;
};

class Plane final : public Shape {
 public:
  AlignedBox3d bounds() const override {
    return {Vector3d(-kInfinity, -kInfinity, 0.0), Vector3d(kInfinity, kInfinity, 0.0)};
  }
  bool intersect(const Ray& ray, double far, Intersection& intersection) const override {
    const double range = -ray.origin.z() / static_cast<double>(ray.direction.z());
    if (!(range >= 0.0 && range <= far)) return false;
    intersection = {range, Vector3d::UnitZ(), 0};
    return true;
  }
};

class Mesh final : public Shape {
 public:
  explicit Mesh(TriangleMesh mesh) : mesh_(std::move(mesh)) {}
  AlignedBox3d bounds() const override { return mesh_.bounds(); }
  bool intersect(const Ray& ray, double far, Intersection& intersection) const override {
    const auto [range, triangle] = tree_.first_hit(ray, far);
    if (triangle == Hit::kNone) return false;
    intersection = {range, mesh_.cross(triangle).normalized(), triangle};
    return true;
  }
  const TriangleMesh& mesh() const { return mesh_; }

 private:
  TriangleMesh mesh_;
  Bvh tree_{mesh_};
};

}  // namespace

ShapePtr make_sphere(double radius) { return std::make_shared<Sphere>(radius); }
ShapePtr make_cylinder(double radius, double length) {
  return std::make_shared<Cylinder>(radius, length);
}
ShapePtr make_plane() { return std::make_shared<Plane>(); }
ShapePtr make_mesh(TriangleMesh mesh) { return std::make_shared<Mesh>(std::move(mesh)); }

const TriangleMesh* mesh_of(const Shape& shape) {
  const auto* mesh = dynamic_cast<const Mesh*>(&shape);
  return mesh == nullptr ? nullptr : &mesh->mesh();
}

}  // namespace lidarena::world
