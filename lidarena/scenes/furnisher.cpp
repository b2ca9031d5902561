// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/scenes/furnisher.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <numbers>

namespace lidarena::scenes {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kTries = 300;
constexpr double kRouteClearance = 0.52;  // m: 0.5 m plus the error of sampling at kRouteStep
constexpr double kRouteStep = 0.04;       // m
constexpr double kGap = 0.02;             // m between pieces
constexpr double kBack = 0.01;            // m between a piece and the wall behind it

/// Rotation about z by `quarters` * 90 degrees with exact cosine and sine, so that boxes stay
/// aligned with the axes.
Pose quarter_turn(int quarters, const Vector3d& position) {
  constexpr std::array kCosine{1.0, 0.0, -1.0, 0.0};
  const double c = kCosine[static_cast<std::size_t>(quarters & 3)];
  const double s = kCosine[static_cast<std::size_t>((quarters + 3) & 3)];
  Pose pose = Pose::Identity();
  pose.linear() << c, -s, 0, s, c, 0, 0, 0, 1;
  pose.translation() = position;
  return pose;
}

AlignedBox3d box_at(const AlignedBox3d& box, const Pose& pose) {
  AlignedBox3d rotated;
  rotated.extend(pose * box.min());
  rotated.extend(pose * box.max());
  return rotated;
}

/// The box around an opening, extended by `along` (m) on both sides and by `ahead` (m) to the front
/// and to the back.
AlignedBox3d box_around(const Opening& opening, double along, double ahead) {
  const Vector3d wide =
      (0.5 * opening.width + along) * (opening.axis == 0 ? Vector3d::UnitX() : Vector3d::UnitY());
  AlignedBox3d box;
  box.extend(opening.point(-ahead, opening.sill) - wide);
  box.extend(opening.point(ahead, opening.head) + wide);
  return box;
}

}  // namespace

double distance_to_route(const AlignedBox3d& box, const std::vector<Vector3d>& route) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < route.size(); ++i) {
    const Vector3d leg = route[i] - route[i - 1];
    const int steps = std::max(1, static_cast<int>(std::ceil(leg.norm() / kRouteStep)));
    for (int k = 0; k <= steps; ++k) {
      nearest = std::min(nearest, box.exteriorDistance(Vector3d(route[i - 1] + leg * k / steps)));
    }
  }
  return nearest;
}

Furnisher::Furnisher(const HousePlan& plan, const HouseConfig& config, SequentialRandom& random)
    : plan_(plan), config_(config), random_(random) {
  for (const Opening& door : plan.doors) {
    AlignedBox3d box = box_around(door, 0.12, 0.6);
    box.max().z() += 0.15;
    keep_out_.push_back(box);
  }
  for (const Opening& window : plan.windows) keep_out_.push_back(box_around(window, 0, 0.3));
}

Eigen::AlignedBox2d Furnisher::inner_floor(RoomUse use) const {
  const Eigen::AlignedBox2d& floor = plan_.room(use).floor;
  const Vector2d inset = Vector2d::Constant(0.5 * config_.wall_thickness_m);
  return {floor.min() + inset, floor.max() - inset};
}

bool Furnisher::is_wanted() {
  return config_.furnishing >= 1.0 || random_.uniform() < config_.furnishing;
}

bool Furnisher::is_free(RoomUse use, const AlignedBox3d& box, Handle ignore) const {
  const Eigen::AlignedBox2d floor = inner_floor(use);
  if (!floor.contains(
          Eigen::AlignedBox2d(Vector2d(box.min().head<2>()), Vector2d(box.max().head<2>())))) {
    return false;
  }
  // Pieces may stand on rugs: an overlap in height of less than kGap is not a collision.
  AlignedBox3d body(box.min() - Vector3d(kGap, kGap, -kGap), box.max() + Vector3d(kGap, kGap, 0));
  if (body.min().z() > body.max().z()) body.max().z() = body.min().z();
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    if (ignore != i && body.intersects(objects_[i].box)) return false;
  }
  const bool rug = box.max().z() < kGap;
  for (const AlignedBox3d& kept : keep_out_) {
    if (!rug && body.intersects(kept)) return false;
  }
  return distance_to_route(box, plan_.route) >= kRouteClearance;
}

Furnisher::Handle Furnisher::fixed(const Piece& piece, const Pose& pose) {
  PlacedObject object{piece.kind, {}, {}, 0};
  object.mesh.append(piece.mesh, pose);
  object.box = object.mesh.bounds();
  if (piece.top > 0) object.top = pose.translation().z() + piece.top;
  objects_.push_back(std::move(object));
  return objects_.size() - 1;
}

Furnisher::Handle Furnisher::try_place(RoomUse use, const Piece& piece, const Pose& pose,
                                       Handle ignore) {
  if (!is_free(use, box_at(piece.mesh.bounds(), pose), ignore)) return {};
  return fixed(piece, pose);
}

Furnisher::Handle Furnisher::against_wall(RoomUse use, const Piece& piece, double z,
                                          std::optional<Side> side) {
  const bool fits = z + piece.mesh.bounds().max().z() < plan_.room(use).height;
  if (!fits || !is_wanted()) return {};
  const Eigen::AlignedBox2d floor = inner_floor(use);
  const AlignedBox3d bounds = piece.mesh.bounds();
  for (int attempt = 0; attempt < kTries; ++attempt) {
    const int quarters = side ? static_cast<int>(*side) : random_.integer(0, 3);
    const bool along_x = quarters % 2 == 0;
    const double length = along_x ? floor.sizes().x() : floor.sizes().y();
    const double room = length - bounds.sizes().x();
    if (room <= 0) continue;
    const double along = 0.5 * bounds.sizes().x() + random_.uniform() * room;
    const double back = -bounds.min().y() + kBack;
    const Vector2d low = floor.min();
    const Vector2d high = floor.max();
    const std::array<Vector2d, 4> feet{
        Vector2d(low.x() + along, low.y() + back), Vector2d(high.x() - back, low.y() + along),
        Vector2d(low.x() + along, high.y() - back), Vector2d(low.x() + back, low.y() + along)};
    const Vector2d foot = feet[static_cast<std::size_t>(quarters)];
    const Pose pose = quarter_turn(quarters, {foot.x(), foot.y(), z});
    if (const Handle placed = try_place(use, piece, pose)) return placed;
  }
  return {};
}

Furnisher::Handle Furnisher::standing(RoomUse use, const Piece& piece, double u, double v) {
  if (!is_wanted()) return {};
  const Eigen::AlignedBox2d floor = inner_floor(use);
  const Vector3d middle = piece.mesh.bounds().center();
  for (int attempt = 0; attempt < kTries; ++attempt) {
    const double stray = 0.5 * attempt / kTries;  // near (u, v) at first, then anywhere
    const Vector2d at(u + random_.uniform(-stray, stray), v + random_.uniform(-stray, stray));
    const Vector2d foot = floor.min() + at.cwiseProduct(floor.sizes());
    Pose pose = quarter_turn(random_.integer(0, 3), Vector3d::Zero());
    pose.translation() =
        Vector3d(foot.x(), foot.y(), 0) - pose.linear() * Vector3d(middle.x(), middle.y(), 0);
    if (const Handle placed = try_place(use, piece, pose)) return placed;
  }
  return {};
}

Furnisher::Handle Furnisher::hanging(RoomUse use, const Piece& piece, double u, double v) {
  if (!is_wanted()) return {};
  const Eigen::AlignedBox2d floor = inner_floor(use);
  for (int attempt = 0; attempt < kTries; ++attempt) {
    const double stray = 0.4 * attempt / kTries;
    const Vector2d at(u + random_.uniform(-stray, stray), v + random_.uniform(-stray, stray));
    const Vector2d foot = floor.min() + at.cwiseProduct(floor.sizes());
    const Pose pose = quarter_turn(0, {foot.x(), foot.y(), plan_.room(use).height});
    if (const Handle placed = try_place(use, piece, pose)) return placed;
  }
  return {};
}

Furnisher::Handle Furnisher::on_top(Handle host, const Piece& piece) {
  if (!host || objects_[*host].top == 0) return {};
  const AlignedBox3d table = objects_[*host].box;
  const double top = objects_[*host].top;
  const AlignedBox3d bounds = piece.mesh.bounds();
  for (int attempt = 0; attempt < kTries; ++attempt) {
    const Pose turn = quarter_turn(random_.integer(0, 3), Vector3d::Zero());
    const AlignedBox3d rotated = box_at(bounds, turn);
    const Vector3d room = table.sizes() - rotated.sizes() - Vector3d::Constant(0.04);
    if (room.head<2>().minCoeff() < 0) continue;
    const Vector2d low = table.min().head<2>() + Vector2d::Constant(0.02);
    const double x = low.x() + random_.uniform() * room.x() - rotated.min().x();
    const double y = low.y() + random_.uniform() * room.y() - rotated.min().y();
    Pose pose = turn;
    pose.translation() = Vector3d(x, y, top);
    const AlignedBox3d box = box_at(bounds, pose);
    const auto hits = [&](const AlignedBox3d& other) { return box.intersects(other); };
    bool free = distance_to_route(box, plan_.route) >= kRouteClearance;
    for (std::size_t i = 0; i < objects_.size(); ++i) {
      free = free && (i == *host || !hits(objects_[i].box));
    }
    if (free) return fixed(piece, pose);
  }
  return {};
}

void Furnisher::around(RoomUse use, Handle host, const std::vector<Piece>& pieces) {
  if (!host) return;
  const AlignedBox3d table = objects_[*host].box;
  const bool long_x = table.sizes().x() >= table.sizes().y();
  const std::size_t per_side = (pieces.size() + 1) / 2;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const double depth = pieces[i].mesh.bounds().max().y();
    const double out = depth - random_.uniform(0.1, 0.25);  // distance from its back to the table
    const double share = (double(i % per_side) + 0.5) / double(per_side);
    const bool low_side = i < per_side;
    const Vector3d low = table.min();
    const Vector3d high = table.max();
    const double along =
        long_x ? low.x() + share * table.sizes().x() : low.y() + share * table.sizes().y();
    const Vector3d foot = long_x ? Vector3d(along, low_side ? low.y() - out : high.y() + out, 0)
                                 : Vector3d(low_side ? low.x() - out : high.x() + out, along, 0);
    const int quarters = long_x ? (low_side ? 0 : 2) : (low_side ? 3 : 1);
    try_place(use, pieces[i], quarter_turn(quarters, foot), host);
  }
}

Furnisher::Handle Furnisher::at_window(const Opening& window, const Piece& piece, double z) {
  if (!is_wanted()) return {};
  // The wall's positive normal points into the house at x = 0 and y = 0.
  const double inward = window.line == 0 ? 1 : -1;
  const Vector3d foot = window.point(inward * (0.5 * config_.wall_thickness_m + kBack), z);
  const int quarters = window.axis == 0 ? (inward > 0 ? 0 : 2) : (inward > 0 ? 3 : 1);
  return fixed(piece, quarter_turn(quarters, foot));
}

}  // namespace lidarena::scenes
