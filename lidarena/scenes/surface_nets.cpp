// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/scenes/surface_nets.hpp"

#include <deque>
#include <unordered_map>

namespace lidarena::scenes {
namespace {

/// Corner c of a cell has the offset (c & 1, c >> 1 & 1, c >> 2).
Eigen::Vector3i corner_offset(int corner) { return {corner & 1, (corner >> 1) & 1, corner >> 2}; }

using Corners = std::array<float, 8>;

/// Reads the samples at the corners of the cell whose lowest corner is `cell`; returns false when
/// one is missing.
bool read_corners(const SparseField& field, const Eigen::Vector3i& cell, Corners& corners) {
  for (int c = 0; c < 8; ++c) {
    const float* value = field.find(cell + corner_offset(c));
    if (value == nullptr) return false;
    corners[static_cast<std::size_t>(c)] = *value;
  }
  return true;
}

/// Bit c is set where corner c is free.
unsigned free_corners(const Corners& corners) {
  unsigned mask = 0;
  for (std::size_t c = 0; c < 8; ++c) mask |= (corners[c] < 0 ? 1U : 0U) << c;
  return mask;
}

/// Lowest corners of the cells that the surface passes through, block by block.
std::vector<Eigen::Vector3i> surface_cells(const SparseField& field) {
  constexpr int kSide = SparseField::kBlock + 1;
  std::vector<Eigen::Vector3i> cells;
  // signs of the samples of one block and of the first samples of its upper neighbors
  std::array<signed char, kSide * kSide * kSide> sign{};
  const auto at = [&](const Eigen::Vector3i& p) -> signed char& {
    return sign[static_cast<std::size_t>(p.x() + kSide * (p.y() + kSide * p.z()))];
  };
  for (const SparseField::Block& block : field.blocks()) {
    const Eigen::Vector3i first = SparseField::kBlock * block.coordinates;
    Eigen::Vector3i p;
    for (p.z() = 0; p.z() < kSide; ++p.z()) {
      for (p.y() = 0; p.y() < kSide; ++p.y()) {
        for (p.x() = 0; p.x() < kSide; ++p.x()) {
          const bool own = p.maxCoeff() < SparseField::kBlock;
          const float* value =
              own ? &block.values[SparseField::index_in_block(p)] : field.find(first + p);
          at(p) = value == nullptr ? 0 : *value < 0 ? -1 : 1;
        }
      }
    }
    for (p.z() = 0; p.z() < SparseField::kBlock; ++p.z()) {
      for (p.y() = 0; p.y() < SparseField::kBlock; ++p.y()) {
        for (p.x() = 0; p.x() < SparseField::kBlock; ++p.x()) {
          int free = 0;
          int rock = 0;
          for (int c = 0; c < 8; ++c) {
            free += at(p + corner_offset(c)) < 0 ? 1 : 0;
            rock += at(p + corner_offset(c)) > 0 ? 1 : 0;
          }
          if (free + rock == 8 && free != 0 && rock != 0) cells.push_back(first + p);
        }
      }
    }
  }
  return cells;
}

/// Bits of the rock corners that make a cell critical; 0 when it is not.
unsigned critical_rock(unsigned free) {
  // Two opposite corners of one kind among six of the other.
  for (unsigned c = 0; c < 4; ++c) {
    const unsigned pair = (1U << c) | (1U << (7 - c));
    if (free == pair) return 0xffU & ~pair;
    if (free == (0xffU & ~pair)) return pair;
  }
  // A checkerboard on one of the six faces.
  for (unsigned axis = 0; axis < 3; ++axis) {
    const unsigned a = 1U << ((axis + 1) % 3);
    const unsigned b = 1U << ((axis + 2) % 3);
    for (const unsigned base : {0U, 1U << axis}) {
      const unsigned one = (1U << base) | (1U << (base + a + b));
      const unsigned other = (1U << (base + a)) | (1U << (base + b));
      if ((free & (one | other)) == one) return other;
      if ((free & (one | other)) == other) return one;
    }
  }
  return 0;
}

/// Position (0 to 1) of the zero on an edge from value a to value b.
double crossing(float a, float b) {
  return static_cast<double>(a) / (static_cast<double>(a) - static_cast<double>(b));
}

/// Mean of the surface's crossings with the cell's twelve edges.
Eigen::Vector3d net_vertex(const SparseField& field, const Eigen::Vector3i& cell) {
  Corners corners{};
  read_corners(field, cell, corners);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int crossings = 0;
  for (int axis = 0; axis < 3; ++axis) {
    for (int c = 0; c < 8; ++c) {
      if ((c >> axis & 1) != 0) continue;
      const float a = corners[static_cast<std::size_t>(c)];
      const float b = corners[static_cast<std::size_t>(c | 1 << axis)];
      if ((a < 0) == (b < 0)) continue;
      Eigen::Vector3d point = corner_offset(c).cast<double>();
      point[axis] += crossing(a, b);
      sum += point;
      ++crossings;
    }
  }
  return field.position(cell) + field.step() * sum / crossings;
}

/// Adds the quad a b c d as two triangles.
void add_quad(world::TriangleMesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c,
              std::uint32_t d) {
  const auto length = [&](std::uint32_t i, std::uint32_t j) {
    return (mesh.vertices[i] - mesh.vertices[j]).squaredNorm();
  };
  if (length(a, c) <= length(b, d)) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  } else {
    mesh.triangles.push_back({b, c, d});
    mesh.triangles.push_back({b, d, a});
  }
}

}  // namespace

std::size_t make_well_composed(SparseField& field) {
  std::size_t changed = 0;
  const std::vector<Eigen::Vector3i> cells = surface_cells(field);
  std::deque<Eigen::Vector3i> open(cells.begin(), cells.end());
  while (!open.empty()) {
    const Eigen::Vector3i cell = open.front();
    open.pop_front();
    Corners corners{};
    if (!read_corners(field, cell, corners)) continue;
    const unsigned rock = critical_rock(free_corners(corners));
    if (rock == 0) continue;
    int shallowest = -1;  // the critical rock corner with the smallest depth
    for (int c = 0; c < 8; ++c) {
      if ((rock >> c & 1) == 0) continue;
      if (shallowest < 0 ||
          corners[static_cast<std::size_t>(c)] < corners[static_cast<std::size_t>(shallowest)]) {
        shallowest = c;
      }
    }
    const Eigen::Vector3i sample = cell + corner_offset(shallowest);
    // Slightly inside free space, so that the crossings do not coincide with the sample.
    *field.find(sample) = static_cast<float>(-0.05 * field.step());
    ++changed;
    for (int c = 0; c < 8; ++c) open.push_back(sample - corner_offset(c));
  }
  return changed;
}

world::TriangleMesh surface_net(const SparseField& field) {
  world::TriangleMesh mesh;
  std::unordered_map<std::uint64_t, std::uint32_t> vertex_of_cell;
  const std::vector<Eigen::Vector3i> cells = surface_cells(field);
  vertex_of_cell.reserve(cells.size());
  mesh.vertices.reserve(cells.size());
  for (const Eigen::Vector3i& cell : cells) {
    vertex_of_cell.emplace(SparseField::key(cell),
                           static_cast<std::uint32_t>(mesh.vertices.size()));
    mesh.vertices.push_back(net_vertex(field, cell));
  }
  mesh.triangles.reserve(2 * cells.size());
  for (const Eigen::Vector3i& cell : cells) {  // the edges that start at the cell's lowest corner
    const float here = *field.find(cell);
    for (int axis = 0; axis < 3; ++axis) {
      const float there = *field.find(cell + Eigen::Vector3i::Unit(axis));
      if ((here < 0) == (there < 0)) continue;
      const Eigen::Vector3i u = Eigen::Vector3i::Unit((axis + 1) % 3);
      const Eigen::Vector3i v = Eigen::Vector3i::Unit((axis + 2) % 3);
      const auto vertex = [&](const Eigen::Vector3i& c) {
        return vertex_of_cell.at(SparseField::key(c));
      };
      const std::uint32_t low = vertex(cell - u - v);
      const std::uint32_t right = vertex(cell - v);
      const std::uint32_t high = vertex(cell);
      const std::uint32_t left = vertex(cell - u);
      // low, right, high, left are counterclockwise about +axis; the field is negative in free
      // space
      if (here < 0) {
        add_quad(mesh, low, left, high, right);
      } else {
        add_quad(mesh, low, right, high, left);
      }
    }
  }
  return mesh;
}

}  // namespace lidarena::scenes
