// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/scenes/mine_plan.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "lidarena/base/error.hpp"
#include "lidarena/base/random.hpp"

namespace lidarena::scenes {
namespace {

using Eigen::Vector3d;

constexpr double kDisturbance = 2.0;     // m, of a junction in plan
constexpr double kMissing = 0.3;         // share of the galleries that are tried to be left out
constexpr double kRoutePointStep = 3.0;  // m
constexpr double kRouteHeight = 1.3;     // m, above the floor

struct Edge {
  std::size_t from, to;
};

std::vector<Edge> grid_edges(const MineConfig& config) {
  const auto columns = static_cast<std::size_t>(config.columns);
  const auto rows = static_cast<std::size_t>(config.rows);
  std::vector<Edge> edges;
  for (std::size_t j = 0; j < rows; ++j) {
    for (std::size_t i = 0; i < columns; ++i) {
      const std::size_t here = j * columns + i;
      if (i + 1 < columns) edges.push_back({here, here + 1});
      if (j + 1 < rows) edges.push_back({here, here + columns});
    }
  }
  return edges;
}

bool is_connected(std::size_t junctions, const std::vector<Edge>& edges) {
  std::vector<std::size_t> group(junctions);
  std::iota(group.begin(), group.end(), std::size_t{0});
  for (const Edge& edge : edges) {
    const std::size_t kept = group[edge.from], joined = group[edge.to];
    std::ranges::replace(group, joined, kept);
  }
  return std::ranges::count(group, group.front()) == static_cast<std::ptrdiff_t>(junctions);
}

/// Leaves galleries out at random where all stays connected and no junction becomes a dead end.
std::vector<Edge> thinned(std::vector<Edge> edges, std::size_t junctions,
                          SequentialRandom& random) {
  const auto tries = static_cast<int>(kMissing * static_cast<double>(edges.size()));
  for (int i = 0; i < tries; ++i) {
    std::vector<Edge> fewer = edges;
    fewer.erase(fewer.begin() + random.integer(0, static_cast<int>(edges.size()) - 1));
    std::vector<int> degree(junctions, 0);
    for (const Edge& edge : fewer) ++degree[edge.from], ++degree[edge.to];
    if (std::ranges::min(degree) >= 2 && is_connected(junctions, fewer)) edges = fewer;
  }
  return edges;
}

/// A dead end, or a neck and a chamber, from the middle of a gallery towards `target`.
void branch_off(const Drift& gallery, const Vector3d& target, SequentialRandom& random,
                MinePlan& plan) {
  const Vector3d middle = 0.5 * (gallery.from + gallery.to);
  Vector3d side = Vector3d::UnitZ().cross(gallery.to - gallery.from).normalized();
  if (side.dot(target - middle) < 0.0) side = -side;
  const double height = gallery.height;
  if (random.uniform() < 0.5) {
    plan.dead_ends.push_back(
        {middle, middle + random.uniform(4.0, 7.0) * side, random.uniform(2.0, 2.6), height});
    return;
  }
  const double width = random.uniform(4.0, 5.0), depth = random.uniform(0.5, 2.0);
  const double wall = 0.5 * gallery.width + 1.0 + 0.5 * width;  // to the chamber's nearer end
  plan.chambers.push_back({middle, middle + wall * side, 2.2, height});
  plan.chambers.push_back({middle + wall * side, middle + (wall + depth) * side, width,
                           height + random.uniform(0.2, 0.8)});
}

void add_branches(const MineConfig& config, SequentialRandom& random, MinePlan& plan) {
  const auto columns = static_cast<std::size_t>(config.columns);
  for (std::size_t j = 0; j + 1 < static_cast<std::size_t>(config.rows); ++j) {
    for (std::size_t i = 0; i + 1 < columns; ++i) {
      const std::size_t corner = j * columns + i;
      const std::array<std::size_t, 4> corners{corner, corner + 1, corner + columns,
                                               corner + columns + 1};
      std::vector<const Gallery*> around;
      Vector3d center = Vector3d::Zero();
      for (const std::size_t c : corners) center += 0.25 * plan.junctions[c];
      for (const Gallery& gallery : plan.galleries) {
        if (std::ranges::count(corners, gallery.from) + std::ranges::count(corners, gallery.to) ==
            2)
          around.push_back(&gallery);
      }
      const bool has_branch = random.uniform() < config.branches;
      const int which = random.integer(0, std::max(0, static_cast<int>(around.size()) - 1));
      if (!has_branch || around.empty()) continue;
      branch_off(around[static_cast<std::size_t>(which)]->drift, center, random, plan);
    }
  }
}

/// The gallery of least use at `junction` other than `last`; the first of several.
std::size_t next_gallery(const MinePlan& plan, std::size_t junction, std::size_t last,
                         const std::vector<int>& used) {
  std::size_t best = plan.galleries.size();
  for (std::size_t g = 0; g < plan.galleries.size(); ++g) {
    const Gallery& gallery = plan.galleries[g];
    if (g == last || (gallery.from != junction && gallery.to != junction)) continue;
    if (best == plan.galleries.size() || used[g] < used[best]) best = g;
  }
  return best;
}

/// The galleries that the route passes, from junction 0 back to it.
std::vector<std::size_t> tour_of(const MinePlan& plan) {
  std::vector<int> used(plan.galleries.size(), 0);
  std::vector<std::size_t> tour;
  std::size_t here = 0, last = plan.galleries.size();
  do {
    last = next_gallery(plan, here, last, used);
    ++used[last];
    tour.push_back(last);
    const Gallery& gallery = plan.galleries[last];
    here = gallery.from == here ? gallery.to : gallery.from;
  } while (here != 0 || last == tour.front() || std::ranges::min(used) == 0);
  return tour;
}

}  // namespace

MinePlan plan_mine(const MineConfig& config, std::uint64_t seed) {
  const double reach = 1.04 * (config.roughness_1m_m + config.roughness_03m_m);
  const double narrow = config.width_min_m + 2.0 * reach, wide = config.width_max_m - 2.0 * reach;
  if (narrow > wide) {
    throw InputError("mine", "width_min_m and width_max_m leave no room for the roughness",
                     "increase their difference or reduce the roughness");
  }
  SequentialRandom random(seed, stream_of("mine plan"));
  MinePlan plan;
  for (int j = 0; j < config.rows; ++j) {
    for (int i = 0; i < config.columns; ++i) {
      const double x = i * config.spacing_m + random.uniform(-kDisturbance, kDisturbance);
      const double y = j * config.spacing_m + random.uniform(-kDisturbance, kDisturbance);
      plan.junctions.emplace_back(x, y, random.uniform(-config.relief_m, config.relief_m));
    }
  }
  for (const Edge& edge : thinned(grid_edges(config), plan.junctions.size(), random)) {
    const double width = random.uniform(narrow, wide);
    const double height = config.height_m + random.uniform(-0.3, 0.3);
    plan.galleries.push_back(
        {edge.from, edge.to, {plan.junctions[edge.from], plan.junctions[edge.to], width, height}});
  }
  add_branches(config, random, plan);
  return plan;
}

std::vector<Vector3d> mine_route(const MinePlan& plan) {
  std::vector<Vector3d> route;
  std::size_t here = 0;
  for (const std::size_t g : tour_of(plan)) {
    const Gallery& gallery = plan.galleries[g];
    const bool forth = gallery.from == here;
    const Vector3d begin = plan.junctions[here];
    here = forth ? gallery.to : gallery.from;
    const Vector3d step = plan.junctions[here] - begin;
    const int count = static_cast<int>(std::ceil(step.norm() / kRoutePointStep));
    for (int i = 0; i < count; ++i) {
      const Vector3d floor = begin + (static_cast<double>(i) / count) * step;
      route.emplace_back(floor + kRouteHeight * Vector3d::UnitZ());
    }
  }
  route.push_back(route.front());
  return route;
}

}  // namespace lidarena::scenes
