// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/world/box_tree.hpp"

#include <algorithm>
#include <numeric>

namespace lidarena::world {

using Eigen::AlignedBox3f;
using Eigen::Vector3f;

namespace {

constexpr std::uint32_t kLeaf = 4;  // a node with at most this number of members is not split
constexpr std::size_t kBins = 16;

/// Half the surface area of the box; 0 for an empty box.
float half_area(const AlignedBox3f& box) {
  if (box.isEmpty()) return 0.0F;
  const Vector3f s = box.sizes();
  return s.x() * s.y() + s.y() * s.z() + s.z() * s.x();
}

/// Divides an axis into `kBins` equal slices (bins) and returns the slice that contains the center
/// of a box.
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

/// A cut between two slices: slices up to and including `last` go to the left child.
struct Cut {
  int axis = 0;
  std::size_t last = 0;
  float cost = std::numeric_limits<float>::infinity();
};

/// Builds the tree from the root down.
class Builder {
 public:
  Builder(std::span<const AlignedBox3f> boxes, std::vector<BoxTree::Node>& nodes,
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
  BoxTree::Node leaf(std::uint32_t first, std::uint32_t count) const {
    BoxTree::Node node{{}, first, count};
    for (std::uint32_t i = first; i < first + count; ++i) node.box.extend(boxes_[order_[i]]);
    return node;
  }

  void split(std::uint32_t node, std::size_t depth) {
    const auto [box, first, count] = nodes_[node];
    const std::span<std::uint32_t> members(order_.data() + first, count);
    AlignedBox3f middles;
    for (const std::uint32_t i : members) middles.extend(Vector3f(boxes_[i].center()));
    const Cut cut = depth < BoxTree::kSahDepth ? cheapest_cut(members, middles) : Cut{};
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

  /// Surface area heuristic: the cost of a side is its surface area times its number of members.
  Cut cheapest_cut(std::span<const std::uint32_t> members, const Slices& slices) const {
    std::array<AlignedBox3f, kBins> box;
    std::array<std::uint32_t, kBins> count{};
    for (const std::uint32_t i : members) {
      const std::size_t slice = slices.of(boxes_[i]);
      box[slice].extend(boxes_[i]);
      ++count[slice];
    }
    std::array<float, kBins> right_cost{};  // cost of all slices after this one
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

  /// Reorders the members by the cut; returns the number of members that go to the left child.
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

  std::span<const AlignedBox3f> boxes_;
  std::vector<BoxTree::Node>& nodes_;
  std::vector<std::uint32_t>& order_;
};

}  // namespace

BoxTree::BoxTree(std::span<const AlignedBox3f> boxes) {
  Builder(boxes, nodes_, members_).run();
  nodes_.shrink_to_fit();
}

void BoxTree::refit(std::span<const AlignedBox3f> boxes) {
  for (auto node = nodes_.rbegin(); node != nodes_.rend(); ++node) {
    node->box.setEmpty();
    for (std::uint32_t i = node->first; i < node->first + node->count; ++i) {
      node->box.extend(boxes[members_[i]]);
    }
    if (node->count > 0) continue;
    node->box.extend(nodes_[node->first].box).extend(nodes_[node->first + 1].box);
  }
}

}  // namespace lidarena::world
