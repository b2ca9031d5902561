// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/flight/tour.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <span>
#include <tuple>

#include "lidarena/base/config_json.hpp"
#include "lidarena/base/error.hpp"
#include "lidarena/flight/coverage.hpp"
#include "lidarena/flight/free_space.hpp"
#include "lidarena/flight/spline_flight.hpp"
#include "lidarena/flight/tour_order.hpp"
#include "lidarena/flight/tour_start.hpp"

namespace lidarena::flight {
namespace {

using Eigen::Vector3d;

constexpr double kSlack = 0.005;          // m; allows for violations between two query points
constexpr double kCoverageSpacing = 0.2;  // m, between viewpoints along the flight

Vector3d start_of(const world::WorldModel& model, const world::World& world,
                  const TourConfig& config, double clearance, const std::string& place,
                  const Parallel& parallel) {
  if (config.start) return *config.start;
  if (!model.routes.empty() && !model.routes.front().empty()) return model.routes.front().front();
  if (const auto found = most_enclosed_place(world, clearance, parallel)) return *found;
  throw InputError(place,
                   fmt::format("no starting point in the world '{}' keeps {:g} m from all surfaces",
                               model.name, clearance),
                   "set tour.start, or reduce clearance_m");
}

FreeSpace explored(const world::World& world, const Vector3d& start, const FlightConfig& config,
                   const std::string& place, const Parallel& parallel) {
  const double minimum = config.clearance_m + config.tour.margin_m + kSlack;
  FreeSpace space(world, start, {minimum, minimum + config.corner_m}, config.tour.voxel_size_m,
                  static_cast<std::size_t>(config.tour.max_voxels), parallel);
  if (space.cells().size() > 1) return space;
  throw InputError(
      place,
      fmt::format("the tour's start ({:.2f}, {:.2f}, {:.2f}) is {:.3f} m from a "
                  "surface, which is too close, or it is outside the mesh's bounding box",
                  start.x(), start.y(), start.z(), world.closest_point(start).distance),
      fmt::format("move tour.start, or reduce clearance_m ({:g})", config.clearance_m));
}

/// The cell with the largest clearance in each block of a coarse grid. The blocks are enlarged
/// until there are at most `most` of them.
std::vector<std::int32_t> spread(const FreeSpace& space, std::size_t most) {
  const auto cells = space.cells();
  for (double edge = 5.0 * space.voxel_size_m();; edge *= 1.25) {
    std::map<std::tuple<std::int64_t, std::int64_t, std::int64_t>, std::int32_t> blocks;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const Vector3d at = (cells[i].point - cells[0].point) / edge;
      const std::tuple block{std::llround(at.x()), std::llround(at.y()), std::llround(at.z())};
      const auto [found, is_new] = blocks.try_emplace(block, static_cast<std::int32_t>(i));
      if (cells[i].clearance > cells[static_cast<std::size_t>(found->second)].clearance) {
        found->second = static_cast<std::int32_t>(i);
      }
    }
    if (blocks.size() > most) continue;
    std::vector<std::int32_t> chosen;
    chosen.reserve(blocks.size());
    for (const auto& [block, cell] : blocks) chosen.push_back(cell);
    return chosen;
  }
}

std::vector<Vector3d> points_of(const FreeSpace& space, std::span<const std::int32_t> cells) {
  std::vector<Vector3d> points;
  points.reserve(cells.size());
  for (const std::int32_t cell : cells) {
    points.push_back(space.cells()[static_cast<std::size_t>(cell)].point);
  }
  return points;
}

/// The cell of the start (the first cell) and the cells of the chosen viewpoints; two or more.
std::vector<std::int32_t> stops(const FreeSpace& space, const std::vector<std::int32_t>& cells,
                                const std::vector<std::size_t>& chosen) {
  std::vector<std::int32_t> all{0};
  for (const std::size_t view : chosen) {
    if (cells[view] != 0) all.push_back(cells[view]);
  }
  if (all.size() == 1) all.push_back(static_cast<std::int32_t>(space.cells().size()) - 1);
  return all;
}

/// The `cells` in the order in which they are visited, starting with the first.
std::vector<std::int32_t> ordered(const FreeSpace& space, const std::vector<std::int32_t>& cells,
                                  const Parallel& parallel) {
  std::vector<std::vector<std::int32_t>> lengths(cells.size());
  parallel.for_each(cells.size(), 1, [&](std::size_t i) {
    const auto all = space.lengths_from(cells[i]);
    for (const std::int32_t cell : cells) {
      lengths[i].push_back(all[static_cast<std::size_t>(cell)]);
    }
  });
  std::vector<std::int32_t> visits;
  for (const std::size_t i : order_of_visits(lengths)) visits.push_back(cells[i]);
  return visits;
}

/// Appends the points of `line` after its first one, which is already in `path`, to its last one,
/// and skips those that a straight segment with this clearance can bypass. The longest segment is
/// found by doubling the number of skipped points, then by bisection.
void append_shortened(const world::World& world, std::span<const Vector3d> line, double clearance,
                      std::vector<Vector3d>& path) {
  for (std::size_t from = 0; from + 1 < line.size();) {
    const std::size_t left = line.size() - 1 - from;
    std::size_t good = 1, bad = left + 1;
    for (std::size_t leap = 2; good < left && bad > left;) {
      leap = std::min(leap, left);
      if (!is_clear(world, line[from], line[from + leap], clearance)) {
        bad = leap;
      } else {
        good = leap;
        leap *= 2;
      }
    }
    while (bad - good > 1) {
      const std::size_t leap = (good + bad) / 2;
      (is_clear(world, line[from], line[from + leap], clearance) ? good : bad) = leap;
    }
    from += good;
    path.push_back(line[from]);
  }
}

/// Appends the path along `cells`, shortened by straight segments: wide sections keep the preferred
/// distance; narrow sections, with one more cell at either end, keep the minimum distance.
void append_path(const world::World& world, const FreeSpace& space,
                 std::span<const std::int32_t> cells, std::vector<Vector3d>& path) {
  const auto wide = [&](std::size_t i) { return space.is_wide(cells[i]); };
  for (std::size_t from = 0; from + 1 < cells.size();) {
    const bool is_wide = wide(from) && wide(from + 1);
    std::size_t to = from + 1;
    while (to + 1 < cells.size() && (wide(to) && wide(to + 1)) == is_wide) ++to;
    const auto line = points_of(space, cells.subspan(from, to - from + 1));
    append_shortened(world, line, is_wide ? space.distances().preferred : space.distances().minimum,
                     path);
    from = to;
  }
}

/// Drops points that are closer than kApart to the previous one.
std::vector<Vector3d> thinned(const std::vector<Vector3d>& path) {
  constexpr double kApart = 0.02;  // m
  std::vector<Vector3d> kept{path.front()};
  for (const Vector3d& point : path) {
    if ((point - kept.back()).norm() > kApart) kept.push_back(point);
  }
  kept.back() = path.back();
  return kept;
}

/// The path from each cell to the next, and from the last to the first.
std::vector<Vector3d> path_through(const world::World& world, const FreeSpace& space,
                                   const std::vector<std::int32_t>& visits) {
  std::vector<Vector3d> path{space.cells()[static_cast<std::size_t>(visits.front())].point};
  for (std::size_t i = 0; i < visits.size(); ++i) {
    append_path(world, space, space.path(visits[i], visits[(i + 1) % visits.size()]), path);
  }
  return thinned(path);
}

/// A corner of the tour. If `reach` (m) is finite, extra waypoints at that distance before and
/// after the corner limit its arc to half of that distance.
struct TourCorner {
  Vector3d point;
  double reach = std::numeric_limits<double>::infinity();
};

std::vector<Vector3d> waypoints_of(const std::vector<TourCorner>& corners) {
  std::vector<Vector3d> waypoints{corners.front().point};
  for (std::size_t i = 1; i < corners.size(); ++i) {
    const Vector3d& from = corners[i - 1].point;
    const Vector3d& to = corners[i].point;
    const double length = (to - from).norm();
    const Vector3d along = (to - from) / length;
    // extra waypoints only where the segment is longer than required for both of its corners
    const double behind = corners[i - 1].reach, before = corners[i].reach;
    constexpr double kApart = 0.01;  // m
    if (behind < 0.5 * length - kApart) waypoints.emplace_back(from + behind * along);
    if (before < 0.5 * length - kApart) waypoints.emplace_back(to - before * along);
    waypoints.push_back(to);
  }
  return waypoints;
}

std::size_t nearest_corner(const std::vector<TourCorner>& corners, const Vector3d& point) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < corners.size(); ++i) {
    if ((corners[i].point - point).norm() < (corners[best].point - point).norm()) best = i;
  }
  return best;
}

double share_of(const Seen& seen) {
  return static_cast<double>(count_seen(seen)) / static_cast<double>(seen.size());
}

/// Corners near which the flight comes closer to a surface than `clearance`.
std::vector<std::size_t> tight_corners(const Flight& flight, const world::World& world,
                                       double clearance, const std::vector<TourCorner>& corners) {
  constexpr Time kStep = std::chrono::milliseconds(5);
  std::vector<std::size_t> tight;
  double margin = 0.0;  // path length within which no new query is needed
  Vector3d last = flight.pose_at(Time{0}).translation();
  for (Time t{0}; t <= flight.duration(); t += kStep) {
    const Vector3d here = flight.pose_at(t).translation();
    margin -= (here - last).norm();
    last = here;
    if (margin > 0.0) continue;
    margin = world.closest_point(here, clearance + 1.0).distance - clearance;
    if (margin >= 0.0) continue;
    const std::size_t corner = nearest_corner(corners, here);
    if (tight.empty() || tight.back() != corner) tight.push_back(corner);
  }
  std::sort(tight.begin(), tight.end());
  tight.erase(std::unique(tight.begin(), tight.end()), tight.end());
  return tight;
}

/// The path as waypoints whose flight keeps the clearance at its corners, if possible.
std::vector<Vector3d> tightened(const std::vector<Vector3d>& path, const world::World& world,
                                const FlightConfig& config, const std::string& place) {
  constexpr int kRounds = 8;
  constexpr double kFirstReach = 0.8;  // m; halved in each further round
  std::vector<TourCorner> corners;
  corners.reserve(path.size());
  for (const Vector3d& point : path) corners.push_back({point});
  for (int round = 0; round < kRounds; ++round) {
    const SplineFlight flight(waypoints_of(corners), config, place);
    const auto tight = tight_corners(flight, world, config.clearance_m, corners);
    if (tight.empty()) break;
    for (const std::size_t i : tight) {
      corners[i].reach = std::min(kFirstReach, 0.5 * corners[i].reach);
    }
  }
  return waypoints_of(corners);
}

}  // namespace

Tour plan_tour(const world::WorldModel& model, const world::World& world,
               const FlightConfig& config, const std::string& place, const Parallel& parallel) {
  const TourConfig& wanted = config.tour;
  const Vector3d start =
      start_of(model, world, wanted, config.clearance_m + wanted.margin_m, place, parallel);
  const FreeSpace space = explored(world, start, config, place, parallel);

  const auto samples = sample_surface(world.mesh(), static_cast<std::size_t>(wanted.samples));
  const auto cells = spread(space, static_cast<std::size_t>(wanted.max_views));
  const auto views =
      seen_from_each(world, points_of(space, cells), samples, wanted.range_m, parallel);
  const auto visits =
      ordered(space, stops(space, cells, choose_views(views, wanted.coverage)), parallel);

  FlightConfig once = config;
  once.duration_s = 0.0;
  Tour tour{.waypoints = tightened(path_through(world, space, visits), world, once, place),
            .views = visits.size() - 1,
            .voxel_size_m = space.voxel_size_m(),
            .cells = space.cells().size()};
  const SplineFlight flight(tour.waypoints, once, place);
  Seen seen = seen_along(world, flight, samples, wanted.range_m, kCoverageSpacing);
  tour.seen = share_of(seen);
  for (const Seen& view : views) add_seen(seen, view);
  tour.seeable = share_of(seen);
  return tour;
}

std::string describe(const Tour& tour) {
  return fmt::format(
      "a tour of {} waypoints through {} viewpoints sees {:.1f} % of what is visible from the {} "
      "reachable cells of {:.2f} m: {:.1f} % of the mesh's area of at most {:.1f} %",
      tour.waypoints.size(), tour.views, 100.0 * tour.seen / std::max(tour.seeable, 1e-12),
      tour.cells, tour.voxel_size_m, 100.0 * tour.seen, 100.0 * tour.seeable);
}

std::string as_yaml(const Tour& tour, const FlightConfig& config) {
  FlightConfig saved = config;
  saved.kind = FlightKind::kWaypoints;
  saved.waypoints = tour.waypoints;
  for (Vector3d& point : saved.waypoints) point = (1e3 * point).array().round() / 1e3;
  return to_json(saved).dump(2) + "\n";  // JSON is valid YAML
}

}  // namespace lidarena::flight
