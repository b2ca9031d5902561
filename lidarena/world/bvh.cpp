// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/world/bvh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace lidarena {

using Eigen::AlignedBox3d;
using Eigen::AlignedBox3f;
using Eigen::Vector3d;
using Eigen::Vector3f;

namespace {

constexpr double kFloatEpsilon = std::numeric_limits<float>::epsilon();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

constexpr std::uint32_t kLeaf = 4;  // triangles in a leaf that is not split further
constexpr std::size_t kBins = 16;
constexpr std::size_t kCheapestDepth = 48;  // below, halves: then the depth is bounded
constexpr std::size_t kMostDepth = kCheapestDepth + 32;

/// How much larger boxes are made: what is lost by rounding them to single precision, and by double
/// arithmetic on coordinates far from the origin.
double box_margin(const AlignedBox3d& bounds) {
  const double largest =
      std::max(bounds.min().lpNorm<Eigen::Infinity>(), bounds.max().lpNorm<Eigen::Infinity>());
  return 4.0 * kFloatEpsilon * bounds.sizes().maxCoeff() +
         64.0 * std::numeric_limits<double>::epsilon() * largest;
}

std::vector<AlignedBox3f> triangle_boxes(const TriangleMesh& mesh, const Vector3d& centre,
                                         double margin) {
  std::vector<AlignedBox3f> boxes(mesh.triangles.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    AlignedBox3d box;
    for (const std::uint32_t corner : mesh.triangles[i]) box.extend(mesh.vertices[corner]);
    const Vector3d low = box.min() - centre, high = box.max() - centre;
    boxes[i] = {(low.array() - margin).cast<float>().matrix(),
                (high.array() + margin).cast<float>().matrix()};
  }
  return boxes;
}

/// Half the surface; an empty box has none.
float half_area(const AlignedBox3f& box) {
  if (box.isEmpty()) return 0.0F;
  const Vector3f s = box.sizes();
  return s.x() * s.y() + s.y() * s.z() + s.z() * s.x();
}

/// Which of equal slices along an axis a box's middle lies in.
struct Slices {
  int axis;
  float low, width;

  Slices(int along, const AlignedBox3f& middles)
      : axis(along), low(middles.min()[along]), width(middles.sizes()[along]) {}
  std::size_t of(const AlignedBox3f& box) const {
    const float place = (box.center()[axis] - low) / width * float{kBins};
    return std::min(static_cast<std::size_t>(std::max(place, 0.0F)), kBins - 1);
  }
};

/// A cut between two slices: those up to `last` go to the left.
struct Cut {
  int axis = 0;
  std::size_t last = 0;
  float cost = std::numeric_limits<float>::infinity();
};

/// Makes the tree, from the root down.
class Builder {
 public:
  Builder(const std::vector<AlignedBox3f>& boxes, std::vector<Bvh::Node>& nodes,
          std::vector<std::uint32_t>& order)
      : boxes_(boxes), nodes_(nodes), order_(order) {}

  void run() {
    order_.resize(boxes_.size());
    std::iota(order_.begin(), order_.end(), 0U);
    nodes_.reserve(2 * boxes_.size());
    nodes_.push_back(leaf(0, static_cast<std::uint32_t>(boxes_.size())));
    std::vector<std::pair<std::uint32_t, std::size_t>> open{{0U, 0U}};  // node, depth
    while (!open.empty()) {
      const auto [node, depth] = open.back();
      open.pop_back();
      if (nodes_[node].count <= kLeaf) continue;
      split(node, depth);
      open.emplace_back(nodes_[node].first, depth + 1);
      open.emplace_back(nodes_[node].first + 1, depth + 1);
    }
  }

 private:
  Bvh::Node leaf(std::uint32_t first, std::uint32_t count) const {
    Bvh::Node node{{}, first, count};
    for (std::uint32_t i = first; i < first + count; ++i) node.box.extend(boxes_[order_[i]]);
    return node;
  }

  void split(std::uint32_t node, std::size_t depth) {
    const auto [box, first, count] = nodes_[node];
    const std::span<std::uint32_t> members(order_.data() + first, count);
    AlignedBox3f middles;
    for (const std::uint32_t i : members) middles.extend(Vector3f(boxes_[i].center()));
    const Cut cut = depth < kCheapestDepth ? cheapest_cut(members, middles) : Cut{};
    const std::uint32_t left =
        std::isfinite(cut.cost) ? divide(members, middles, cut) : halve(members, middles);
    nodes_[node].first = static_cast<std::uint32_t>(nodes_.size());
    nodes_[node].count = 0;
    nodes_.push_back(leaf(first, left));
    nodes_.push_back(leaf(first + left, count - left));
  }

  Cut cheapest_cut(std::span<const std::uint32_t> members, const AlignedBox3f& middles) const {
    Cut best;
    for (int axis = 0; axis < 3; ++axis) {
      if (!(middles.sizes()[axis] > 0.0F)) continue;
      const Cut cut = cheapest_cut(members, Slices(axis, middles));
      if (cut.cost < best.cost) best = cut;
    }
    return best;
  }

  /// The surface area heuristic: a side costs its surface times the number of its triangles.
  Cut cheapest_cut(std::span<const std::uint32_t> members, const Slices& slices) const {
    std::array<AlignedBox3f, kBins> box;
    std::array<std::uint32_t, kBins> count{};
    for (const std::uint32_t i : members) {
      const std::size_t slice = slices.of(boxes_[i]);
      box[slice].extend(boxes_[i]);
      ++count[slice];
    }
    std::array<float, kBins> right_cost{};  // of all slices beyond
    AlignedBox3f side;
    std::uint32_t members_of_side = 0;
    for (std::size_t i = kBins - 1; i > 0; --i) {
      side.extend(box[i]);
      members_of_side += count[i];
      right_cost[i - 1] = half_area(side) * static_cast<float>(members_of_side);
    }
    Cut best;
    side.setEmpty();
    members_of_side = 0;
    for (std::size_t i = 0; i + 1 < kBins; ++i) {
      side.extend(box[i]);
      members_of_side += count[i];
      if (members_of_side == 0 || members_of_side == members.size()) continue;
      const float cost = half_area(side) * static_cast<float>(members_of_side) + right_cost[i];
      if (cost < best.cost) best = {slices.axis, i, cost};
    }
    return best;
  }

  /// Returns how many go to the left.
  std::uint32_t divide(std::span<std::uint32_t> members, const AlignedBox3f& middles,
                       const Cut& cut) const {
    const Slices slices(cut.axis, middles);
    const auto middle = std::stable_partition(members.begin(), members.end(), [&](std::uint32_t i) {
      return slices.of(boxes_[i]) <= cut.last;
    });
    return static_cast<std::uint32_t>(middle - members.begin());
  }

  std::uint32_t halve(std::span<std::uint32_t> members, const AlignedBox3f& middles) const {
    int axis = 0;
    middles.sizes().maxCoeff(&axis);
    const auto before = [&](std::uint32_t a, std::uint32_t b) {
      const float place_a = boxes_[a].center()[axis], place_b = boxes_[b].center()[axis];
      return place_a < place_b || (place_a == place_b && a < b);
    };
    const auto half = static_cast<std::uint32_t>(members.size() / 2);
    std::nth_element(members.begin(), members.begin() + half, members.end(), before);
    return half;
  }

  const std::vector<AlignedBox3f>& boxes_;
  std::vector<Bvh::Node>& nodes_;
  std::vector<std::uint32_t>& order_;
};

/// Nodes still to be looked into, each with how far away it begins.
template <typename Node>
class Stack {
 public:
  bool empty() const { return size_ == 0; }
  void push(const Node* node, double near) { entries_[size_++] = {node, near}; }
  std::pair<const Node*, double> pop() { return entries_[--size_]; }
  /// The nearer of two comes to lie on top.
  void push_both(const Node* a, double near_a, const Node* b, double near_b) {
    if (near_a <= near_b) {
      std::swap(a, b);
      std::swap(near_a, near_b);
    }
    if (near_a < kInfinity) push(a, near_a);
    if (near_b < kInfinity) push(b, near_b);
  }

 private:
  std::array<std::pair<const Node*, double>, kMostDepth + 2> entries_;
  std::size_t size_ = 0;
};

/// A ray against boxes: for each axis the near and the far side are known beforehand.
struct BoxTest {
  Vector3d origin, inverse;
  std::array<bool, 3> backwards;

  BoxTest(const Vector3d& centred, const Vector3d& direction) : origin(centred) {
    constexpr double kParallel = 1e-30;  // a zero would make 0 * infinity of a box's side
    for (int axis = 0; axis < 3; ++axis) {
      const double size = std::max(std::abs(direction[axis]), kParallel);
      inverse[axis] = 1.0 / std::copysign(size, direction[axis]);
      backwards[axis] = direction[axis] < 0.0 || inverse[axis] < 0.0;
    }
  }

  /// Where the ray enters the box between `near` and `far`; infinity when it does not.
  double entry(const AlignedBox3f& box, double near, double far) const {
    for (int axis = 0; axis < 3; ++axis) {
      const double low = (double{box.min()[axis]} - origin[axis]) * inverse[axis];
      const double high = (double{box.max()[axis]} - origin[axis]) * inverse[axis];
      near = std::max(near, backwards[axis] ? high : low);
      far = std::min(far, backwards[axis] ? low : high);
    }
    return near <= far ? near : kInfinity;
  }
};

/// A ray against triangles. Seen in coordinates in which the ray is the z axis, each edge has the
/// origin on its left or its right; two triangles that share an edge compute the same number for it
/// but for its sign, so that a ray cannot pass outside both. Needs products that are rounded before
/// they are subtracted: see -ffp-contract in CMakeLists.txt.
struct TriangleTest {
  Vector3d origin;
  int x, y, z;  ///< axes; the ray's direction is largest along z
  double shear_x, shear_y, scale;

  TriangleTest(const Vector3d& from, const Vector3d& direction) : origin(from) {
    direction.cwiseAbs().maxCoeff(&z);
    x = (z + 1) % 3;
    y = (z + 2) % 3;
    shear_x = direction[x] / direction[z];
    shear_y = direction[y] / direction[z];
    scale = 1.0 / direction[z];
  }

  Vector3d sheared(const Vector3d& vertex) const {
    const Vector3d v = vertex - origin;
    return {v[x] - shear_x * v[z], v[y] - shear_y * v[z], scale * v[z]};
  }

  /// Range of the hit; negative or NaN when the ray's line does not meet the triangle before it.
  double range(const Vector3d& corner_a, const Vector3d& corner_b, const Vector3d& corner_c) const {
    const Vector3d a = sheared(corner_a), b = sheared(corner_b), c = sheared(corner_c);
    const double u = c.x() * b.y() - c.y() * b.x();
    const double v = a.x() * c.y() - a.y() * c.x();
    const double w = b.x() * a.y() - b.y() * a.x();
    const bool some_left = u < 0.0 || v < 0.0 || w < 0.0;
    const bool some_right = u > 0.0 || v > 0.0 || w > 0.0;
    if (some_left == some_right) return -1.0;  // outside, or seen edge-on
    return (u * a.z() + v * b.z() + w * c.z()) / (u + v + w);
  }
};

bool can_hit(const Ray& ray) {
  return ray.origin.allFinite() && ray.direction.allFinite() && !ray.direction.isZero(0.0F);
}

}  // namespace

Bvh::Bvh(const TriangleMesh& mesh) : mesh_(mesh) {
  const AlignedBox3d bounds = mesh.bounds();
  centre_ = bounds.center();
  const auto boxes = triangle_boxes(mesh, centre_, box_margin(bounds));
  Builder(boxes, nodes_, triangles_).run();
  nodes_.shrink_to_fit();
}

/// Calls `meet(triangle, range)` for what the ray meets between `near` and `far`, which `meet` may
/// bring nearer, roughly from near to far.
template <typename Meet>
void Bvh::walk(const Ray& ray, double near, double& far, const Meet& meet) const {
  if (!can_hit(ray)) return;
  const Vector3d direction = ray.direction.cast<double>();
  const BoxTest boxes(ray.origin - centre_, direction);
  const TriangleTest triangles(ray.origin, direction);
  Stack<Node> stack;
  stack.push(nodes_.data(), boxes.entry(nodes_[0].box, near, far));
  while (!stack.empty()) {
    const auto [node, entry] = stack.pop();
    if (!(entry <= far)) continue;
    if (node->count == 0) {
      const Node* child = &nodes_[node->first];
      stack.push_both(child, boxes.entry(child[0].box, near, far),  //
                      child + 1, boxes.entry(child[1].box, near, far));
      continue;
    }
    for (std::uint32_t i = node->first; i < node->first + node->count; ++i) {
      const auto& [a, b, c] = mesh_.triangles[triangles_[i]];
      const auto& v = mesh_.vertices;
      const double range = triangles.range(v[a], v[b], v[c]);
      if (range >= near && range <= far) meet(triangles_[i], range);
    }
  }
}

void Bvh::cast(std::span<const Ray> rays, double max_range, std::span<Hit> hits,
               RayOrder /*order*/) const {
  for (std::size_t i = 0; i < rays.size(); ++i) {
    Hit hit;
    double far = max_range;
    walk(rays[i], 0.0, far, [&](std::uint32_t triangle, double range) {
      if (range == far && triangle > hit.triangle) return;
      far = range;
      hit.triangle = triangle;
    });
    if (hit.valid()) hit.range = static_cast<float>(far);
    hits[i] = hit;
  }
}

bool Bvh::occluded(const Ray& ray, double near, double far) const {
  bool is_blocked = false;
  walk(ray, near, far, [&](std::uint32_t /*triangle*/, double /*range*/) {
    is_blocked = true;
    far = -kInfinity;  // one is enough
  });
  return is_blocked;
}

void Bvh::visit_near(const Vector3d& point, double radius, TriangleVisitor& visitor) const {
  if (!point.allFinite()) return;
  const Vector3d centred = point - centre_;
  const auto widened2 = [](double r) { return r * r * (1.0 + 8.0 * kFloatEpsilon); };
  const auto distance2 = [&](const Node& node) {
    return node.box.cast<double>().squaredExteriorDistance(centred);
  };
  double reach2 = widened2(radius);
  Stack<Node> stack;
  stack.push(nodes_.data(), distance2(nodes_[0]));
  while (!stack.empty()) {
    const auto [node, near2] = stack.pop();
    if (near2 > reach2) continue;
    if (node->count == 0) {
      const Node* child = &nodes_[node->first];
      stack.push_both(child, distance2(child[0]), child + 1, distance2(child[1]));
      continue;
    }
    for (std::uint32_t i = node->first; i < node->first + node->count; ++i) {
      reach2 = widened2(visitor.visit(triangles_[i]));
    }
  }
}

}  // namespace lidarena
