// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/flight/people.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "lidarena/base/random.hpp"

namespace lidarena::flight {
namespace {

using Eigen::Vector3d;

constexpr double kRadius = 0.32;       // m, free space around a person's axis
constexpr double kStep = 0.3;          // m, between the places that are checked on a way
constexpr double kMaxFloorStep = 0.1;  // m, change of the floor's height from one to the next
constexpr double kShortestWay = 1.0;   // m
constexpr int kDirections = 8;         // drawn for the way of a person; the longest is taken
constexpr int kTries = 300;            // per person

/// The floor below `p`, if it is level enough to stand on and free up to a person's height.
std::optional<Vector3d> floor_below(const world::World& world, const Vector3d& p) {
  const world::Ray down{p, Eigen::Vector3f(0, 0, -1)};
  world::Hit hit;
  world.cast({&down, 1}, 6.0, {&hit, 1});
  if (!hit.valid() || hit.normal.z() < 0.9F) return std::nullopt;
  const Vector3d floor = p - Vector3d(0, 0, static_cast<double>(hit.range));
  for (const double height : {0.4, 0.9, 1.5}) {
    if (world.closest_point(floor + Vector3d(0, 0, height), kRadius).valid()) return std::nullopt;
  }
  return floor;
}

bool is_beside(const std::vector<Vector3d>& flown, const Vector3d& place) {
  for (const Vector3d& p : flown) {
    if ((p - place).head<2>().norm() < kPeopleClearance) return false;
  }
  return true;
}

/// A place to stand within sight of a random place of the flight.
std::optional<Vector3d> draw_place(const world::World& world, const std::vector<Vector3d>& flown,
                                   SequentialRandom& random) {
  const Vector3d& from =
      flown[static_cast<std::size_t>(random.uniform() * static_cast<double>(flown.size()))];
  const double angle = random.uniform(0.0, 2.0 * std::numbers::pi);
  const double distance = random.uniform(kPeopleClearance, 6.0);
  const Vector3d to = from + distance * Vector3d(std::cos(angle), std::sin(angle), 0.0);
  if (!world.visible(from, to)) return std::nullopt;
  const auto floor = floor_below(world, to);
  return floor && is_beside(flown, *floor) ? floor : std::nullopt;
}

/// The end of the straight way from `start` in a drawn direction, up to a drawn length.
Vector3d draw_end(const world::World& world, const std::vector<Vector3d>& flown,
                  const Vector3d& start, SequentialRandom& random) {
  const double angle = random.uniform(0.0, 2.0 * std::numbers::pi);
  const double length = random.uniform(1.5, 6.0);
  const Vector3d ahead(std::cos(angle), std::sin(angle), 0.0);
  Vector3d end = start;
  for (double s = kStep; s <= length; s += kStep) {
    const auto next =
        floor_below(world, start + s * ahead + Vector3d(0, 0, end.z() - start.z() + 1.0));
    if (!next || std::abs(next->z() - end.z()) > kMaxFloorStep || !is_beside(flown, *next)) break;
    end = *next;
  }
  return end;
}

/// The farthest of the ends of kDirections drawn ways.
Vector3d draw_far_end(const world::World& world, const std::vector<Vector3d>& flown,
                      const Vector3d& start, SequentialRandom& random) {
  Vector3d farthest = start;
  for (int i = 0; i < kDirections; ++i) {
    const Vector3d end = draw_end(world, flown, start, random);
    if ((end - start).norm() > (farthest - start).norm()) farthest = end;
  }
  return farthest;
}

std::vector<Vector3d> flown_places(const Flight& flight) {
  std::vector<Vector3d> places;
  for (Time t{0}; t <= flight.duration(); t += std::chrono::milliseconds(100))
    places.push_back(flight.pose_at(t).translation());
  return places;
}

}  // namespace

std::vector<world::MoverConfig> draw_people(const world::World& world, const Flight& flight,
                                            int count, std::uint64_t seed) {
  SequentialRandom random(seed, stream_of("people"));
  const std::vector<Vector3d> flown = flown_places(flight);
  std::vector<world::MoverConfig> people;
  for (int tries = 0; tries < kTries * count && static_cast<int>(people.size()) < count; ++tries) {
    const auto place = draw_place(world, flown, random);
    if (!place) continue;
    const Vector3d end = draw_far_end(world, flown, *place, random);
    world::MoverConfig person;
    person.name = "person " + std::to_string(people.size() + 1);
    person.path = {*place};
    if ((end - *place).norm() >= kShortestWay) person.path.push_back(end);
    person.speed = random.uniform(0.6, 1.4);
    person.start_s = random.uniform(0.0, 60.0);
    person.height_m = random.uniform(1.55, 1.9);
    people.push_back(person);
  }
  return people;
}

}  // namespace lidarena::flight
