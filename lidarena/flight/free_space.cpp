// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/flight/free_space.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

namespace lidarena::flight {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;
using Cell = FreeSpace::Cell;
using Grid = std::unordered_map<std::uint64_t, std::int32_t>;  // cell index, kBlocked or kOpen

constexpr double kCoarseFactor = 4.0;  // factor on the cell size in the first exploration
constexpr double kFar = 1.0;           // m; larger distances are treated as equal
constexpr std::int32_t kBlocked = -2;  // visited, too close to a surface or not connected
constexpr std::int32_t kOpen = -3;     // to be visited next
constexpr std::array<std::array<int, 3>, 6> kSteps{
    {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}}};

Vector3i stepped(const Vector3i& at, std::size_t side) {
  return at + Vector3i(kSteps[side][0], kSteps[side][1], kSteps[side][2]);
}

/// Hash key with 21 bits per coordinate; coordinates are relative to the start and may be negative.
std::uint64_t key_of(const Vector3i& at) {
  constexpr std::int64_t kHalf = 1 << 20;
  std::uint64_t key = 0;
  for (int i = 0; i < 3; ++i) key = key << 21U | static_cast<std::uint64_t>(at[i] + kHalf);
  return key;
}

/// Cell whose point is moved by hill climbing to the place in the cube around `center` that is
/// farthest from the surface. The point stays at the center if that already has the preferred
/// distance, or if the minimum distance cannot be reached within the cube.
Cell adjusted_cell(const world::World& world, const Vector3d& center, double edge,
                   const Distances& wanted) {
  Cell cell{center, 0.0, {}};
  cell.next.fill(FreeSpace::kNone);
  world::ClosestPoint nearest = world.closest_point(center, kFar);
  cell.clearance = std::min(nearest.distance, kFar);
  const double most = cell.clearance + 0.5 * std::sqrt(3.0) * edge;
  if (most < wanted.minimum || cell.clearance == 0.0) return cell;
  for (double step = 0.5 * edge; step > 0.1 * edge && cell.clearance < wanted.preferred;
       step *= 0.5) {
    const Vector3d away = (cell.point - nearest.point) / nearest.distance;
    const Vector3d offset = (cell.point + step * away - center).cwiseMax(-0.5 * edge);
    const Vector3d there = center + offset.cwiseMin(0.5 * edge);
    const world::ClosestPoint next = world.closest_point(there, kFar);
    if (next.distance < cell.clearance + 1e-3) continue;
    cell.point = there;
    cell.clearance = std::min(next.distance, kFar);
    nearest = next;
    step *= 2.0;  // keep the step size after a successful step
  }
  return cell;
}

/// True when the line between the points of two cells keeps the distance `minimum`. This follows
/// from the clearances at both ends if they are large enough; otherwise the world is queried.
bool is_joined(const world::World& world, const Cell& a, const Cell& b, double minimum) {
  const double apart = (a.point - b.point).norm();
  if (0.5 * (a.clearance + b.clearance - apart) >= minimum) return true;
  return is_clear(world, a.point, b.point, minimum);
}

/// Connects `cell` at the grid coordinates `at`, which will be appended to `cells`, with its
/// neighbors; returns false if it cannot be connected with any.
bool join(const world::World& world, double minimum, const Grid& grid, const Vector3i& at,
          Cell& cell, std::vector<Cell>& cells) {
  bool joined = false;
  for (std::size_t side = 0; side < kSteps.size(); ++side) {
    const auto other = grid.find(key_of(stepped(at, side)));
    if (other == grid.end() || other->second < 0) continue;
    Cell& neighbor = cells[static_cast<std::size_t>(other->second)];
    if (!is_joined(world, cell, neighbor, minimum)) continue;
    cell.next[side] = other->second;
    neighbor.next[side ^ 1U] = static_cast<std::int32_t>(cells.size());
    joined = true;
  }
  return joined;
}

}  // namespace

FreeSpace::FreeSpace(const world::World& world, const Vector3d& start, const Distances& distances,
                     double voxel_size_m, std::size_t max_voxels, const Parallel& parallel)
    : distances_(distances), voxel_size_m_(kCoarseFactor * voxel_size_m) {
  const bool is_small = explore(world, start, max_voxels, parallel);
  const double expected = static_cast<double>(cells_.size()) * std::pow(kCoarseFactor, 3);
  const double excess = expected / static_cast<double>(max_voxels);
  voxel_size_m_ = is_small ? voxel_size_m * std::max(1.0, std::cbrt(excess)) : 1.5 * voxel_size_m_;
  while (!explore(world, start, max_voxels, parallel)) voxel_size_m_ *= 1.5;
}

bool FreeSpace::explore(const world::World& world, const Vector3d& start, std::size_t max_voxels,
                        const Parallel& parallel) {
  const Eigen::AlignedBox3d box = world.mesh().bounds();
  cells_.clear();
  Grid grid;
  std::vector<Vector3i> wave{Vector3i::Zero()};
  std::vector<Vector3i> at;  // grid coordinates of each cell
  while (!wave.empty() && cells_.size() <= max_voxels) {
    std::vector<Cell> looked_at(wave.size());
    parallel.for_each(wave.size(), 32, [&](std::size_t i) {
      const Vector3d center = start + voxel_size_m_ * wave[i].cast<double>();
      looked_at[i] = adjusted_cell(world, center, voxel_size_m_, distances_);
    });
    const std::size_t first_new = cells_.size();
    for (std::size_t i = 0; i < wave.size(); ++i) {
      grid[key_of(wave[i])] = kBlocked;
      Cell& cell = looked_at[i];
      if (cell.clearance < distances_.minimum || !box.contains(cell.point)) continue;
      if (!join(world, distances_.minimum, grid, wave[i], cell, cells_) && !cells_.empty())
        continue;
      grid[key_of(wave[i])] = static_cast<std::int32_t>(cells_.size());
      cells_.push_back(cell);
      at.push_back(wave[i]);
    }
    wave.clear();
    for (std::size_t k = first_new; k < cells_.size(); ++k) {
      for (std::size_t side = 0; side < kSteps.size(); ++side) {
        const Vector3i next = stepped(at[k], side);
        if (grid.try_emplace(key_of(next), kOpen).second) wave.push_back(next);
      }
    }
  }
  return cells_.size() <= max_voxels;
}

namespace {

/// Dijkstra's algorithm for integer lengths with a ring of buckets (Dial, CACM 1969). Stops when
/// the cell `until` is reached.
std::vector<std::int32_t> shortest(const FreeSpace& space, std::int32_t from, std::int32_t until) {
  constexpr std::int32_t kWide = 2;
  constexpr std::int32_t kNarrow = 6;
  const auto cells = space.cells();
  std::vector<std::int32_t> length(cells.size(), std::numeric_limits<std::int32_t>::max());
  std::array<std::vector<std::int32_t>, kNarrow + 1> ring;
  length[static_cast<std::size_t>(from)] = 0;
  ring[0].push_back(from);
  std::size_t waiting = 1;
  for (std::int32_t now = 0; waiting > 0; ++now) {
    auto& bucket = ring[static_cast<std::size_t>(now) % ring.size()];
    waiting -= bucket.size();
    for (const std::int32_t index : bucket) {
      if (length[static_cast<std::size_t>(index)] != now) continue;
      if (index == until) return length;
      for (const std::int32_t next : cells[static_cast<std::size_t>(index)].next) {
        if (next == FreeSpace::kNone) continue;
        const std::int32_t there =
            now + (space.is_wide(next) && space.is_wide(index) ? kWide : kNarrow);
        if (there >= length[static_cast<std::size_t>(next)]) continue;
        length[static_cast<std::size_t>(next)] = there;
        ring[static_cast<std::size_t>(there) % ring.size()].push_back(next);
        ++waiting;
      }
    }
    bucket.clear();
  }
  return length;
}

}  // namespace

std::vector<std::int32_t> FreeSpace::lengths_from(std::int32_t from) const {
  return shortest(*this, from, kNone);
}

std::vector<std::int32_t> FreeSpace::path(std::int32_t from, std::int32_t to) const {
  const std::vector<std::int32_t> length = shortest(*this, to, from);
  std::vector<std::int32_t> cells{from};
  while (cells.back() != to) {
    std::int32_t best = kNone;
    for (const std::int32_t next : cells_[static_cast<std::size_t>(cells.back())].next) {
      if (next == kNone) continue;
      const auto of = [&](std::int32_t cell) { return length[static_cast<std::size_t>(cell)]; };
      if (best == kNone || of(next) < of(best)) best = next;
    }
    cells.push_back(best);
  }
  return cells;
}

bool is_clear(const world::World& world, const Vector3d& from, const Vector3d& to,
              double clearance) {
  constexpr double kMinStep = 0.02;  // m
  const double length = (to - from).norm();
  if (length > 0.0 && !world.visible(from, to)) return false;
  for (double s = 0.0;;) {
    const Vector3d here = length > 0.0 ? Vector3d(from + s / length * (to - from)) : from;
    const double room = world.closest_point(here, clearance + kFar).distance - clearance;
    if (room < 0.0) return false;
    if (s >= length) return true;
    s = std::min(length, s + std::clamp(room, kMinStep, kFar));
  }
}

}  // namespace lidarena::flight
