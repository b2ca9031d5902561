// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/scenes/cave_graph.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lidarena/base/random.hpp"

namespace lidarena::scenes {
namespace {

using std::numbers::pi;
constexpr double kPointSpacing = 0.5;  // m, small compared with the wavelengths of the winding
constexpr double kRouteSpacing = 1.5;  // m
constexpr double kMaxHeading = 0.35;   // rad; neighboring cells differ by at most twice this
/// Expected change of a tunnel's radius by the noise, as a fraction of the noise amplitudes:
/// gradient noise rarely exceeds 0.6.
constexpr double kRoughnessReach = 0.6;

// A ladder of n cells: junctions 2 i (left rail) and 2 i + 1 (right rail) lie at rung i of 0 ... n;
// the tunnels are the rungs 0 ... n, then left and right rail of each cell.
std::size_t junction(std::size_t rung, std::size_t side) { return 2 * rung + side; }
std::size_t rail(std::size_t cells, std::size_t cell, std::size_t side) {
  return cells + 1 + 2 * cell + side;
}

std::vector<Eigen::Vector3d> ladder_junctions(const CaveConfig& config, SequentialRandom& random) {
  std::vector<double> heading;
  for (int i = 0; i < config.loops; ++i) {
    heading.push_back(random.uniform(-kMaxHeading, kMaxHeading));
  }
  std::vector<Eigen::Vector3d> junctions;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (int i = 0; i <= config.loops; ++i) {
    const double before = heading[static_cast<std::size_t>(std::max(i - 1, 0))];
    const double after = heading[static_cast<std::size_t>(std::min(i, config.loops - 1))];
    const double across = 0.5 * (before + after) + 0.5 * pi;
    const Eigen::Vector3d half =
        0.5 * config.cell_width_m * Eigen::Vector3d(std::cos(across), std::sin(across), 0);
    for (const double sign : {1.0, -1.0}) {
      const double height = random.uniform(-config.relief_m, config.relief_m);
      junctions.emplace_back(center + sign * half + height * Eigen::Vector3d::UnitZ());
    }
    center += config.cell_length_m * Eigen::Vector3d(std::cos(after), std::sin(after), 0);
  }
  return junctions;
}

/// A slow random oscillation between -1 and 1: a long wave plus a shorter one, so that it is not
/// periodic. The wavelengths (m) keep the centerline's bend radius above the tunnel's radius.
class Swing {
 public:
  explicit Swing(SequentialRandom& random)
      : long_(2 * pi / random.uniform(14, 22)),
        short_(2 * pi / random.uniform(9, 12)),
        long_phase_(random.uniform(0, 2 * pi)),
        short_phase_(random.uniform(0, 2 * pi)) {}

  double at(double s) const {
    return 0.8 * std::sin(long_ * s + long_phase_) + 0.2 * std::sin(short_ * s + short_phase_);
  }

 private:
  double long_, short_, long_phase_, short_phase_;
};

Tunnel winding_tunnel(const CaveConfig& config, const std::vector<Eigen::Vector3d>& junctions,
                      std::size_t from, std::size_t to, SequentialRandom& random) {
  const double reach =
      kRoughnessReach * (config.roughness_2m_m + config.roughness_03m_m + config.roughness_005m_m);
  const double radius_min = 0.5 * config.width_min_m + reach;
  const double radius_max = 0.5 * config.width_max_m - reach;
  if (radius_min > radius_max) {
    throw InputError("cave", "width_min_m and width_max_m leave no room for the roughness",
                     "increase their difference or reduce the roughness");
  }
  const Eigen::Vector3d chord = junctions[to] - junctions[from];
  const Eigen::Vector3d side = chord.cross(Eigen::Vector3d::UnitZ()).normalized();
  const Swing lateral(random);
  const Swing vertical(random);
  const Swing radial(random);
  Tunnel tunnel{from, to, {}, {}};
  const int steps = static_cast<int>(std::ceil(chord.norm() / kPointSpacing));
  for (int i = 0; i <= steps; ++i) {
    const double u = static_cast<double>(i) / steps;
    const double s = u * chord.norm();
    const double inner = std::sin(pi * u);  // fades to 0 at the junctions
    const Eigen::Vector3d swing = config.winding_m * lateral.at(s) * side +
                                  0.4 * config.relief_m * vertical.at(s) * Eigen::Vector3d::UnitZ();
    tunnel.points.emplace_back(junctions[from] + u * chord + inner * swing);
    // At the junctions the tunnel has its maximum width.
    const double wide = 1 - inner * (0.5 - 0.5 * radial.at(s));
    tunnel.radii.push_back(radius_min + (radius_max - radius_min) * wide);
  }
  return tunnel;
}

/// Junctions in the order in which the route passes them; the last equals the first.
std::vector<std::size_t> route_junctions(std::size_t cells) {
  std::vector<std::size_t> order{junction(0, 0)};
  std::size_t side = 0;
  for (std::size_t rung = 1; rung <= cells; ++rung) {
    order.push_back(junction(rung, side));
    side = 1 - side;
    order.push_back(junction(rung, side));
  }
  for (std::size_t rung = cells; rung-- > 0;) {
    order.push_back(junction(rung, side));
    side = 1 - side;
    order.push_back(junction(rung, side));
  }
  return order;
}

/// The centerline between two neighboring junctions, from `from` to `to`.
std::vector<Eigen::Vector3d> tunnel_points(const CaveGraph& graph, std::size_t from,
                                           std::size_t to) {
  for (const Tunnel& tunnel : graph.tunnels) {
    if (tunnel.from == from && tunnel.to == to) return tunnel.points;
    if (tunnel.from == to && tunnel.to == from) {
      return {tunnel.points.rbegin(), tunnel.points.rend()};
    }
  }
  return {};
}

}  // namespace

double Tunnel::length() const {
  double sum = 0;
  for (std::size_t i = 1; i < points.size(); ++i) sum += (points[i] - points[i - 1]).norm();
  return sum;
}

CaveGraph make_cave_graph(const CaveConfig& config, std::uint64_t seed) {
  SequentialRandom random(seed, stream_of("cave graph"));
  CaveGraph graph;
  graph.junctions = ladder_junctions(config, random);
  const auto cells = static_cast<std::size_t>(config.loops);
  const auto add = [&](std::size_t from, std::size_t to) {
    graph.tunnels.push_back(winding_tunnel(config, graph.junctions, from, to, random));
  };
  for (std::size_t i = 0; i <= cells; ++i) add(junction(i, 0), junction(i, 1));
  for (std::size_t i = 0; i < cells; ++i) {
    for (const std::size_t side : {0U, 1U}) add(junction(i, side), junction(i + 1, side));
    graph.loops.push_back({i, rail(cells, i, 0), i + 1, rail(cells, i, 1)});
  }
  return graph;
}

std::vector<Eigen::Vector3d> cave_route(const CaveGraph& graph) {
  const std::vector<std::size_t> order = route_junctions(graph.loops.size());
  std::vector<Eigen::Vector3d> route{graph.junctions[order.front()]};
  for (std::size_t leg = 1; leg < order.size(); ++leg) {
    const std::vector<Eigen::Vector3d> points = tunnel_points(graph, order[leg - 1], order[leg]);
    for (std::size_t i = 1; i + 1 < points.size(); ++i) {
      const bool far = (points[i] - route.back()).norm() >= kRouteSpacing - 0.5 * kPointSpacing;
      const bool room = (points[i] - points.back()).norm() >= 0.6 * kRouteSpacing;
      if (far && room) route.push_back(points[i]);
    }
    route.push_back(points.back());
  }
  return route;
}

}  // namespace lidarena::scenes
