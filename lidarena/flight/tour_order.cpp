// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/flight/tour_order.hpp"

#include <algorithm>

namespace lidarena::flight {
namespace {

using Lengths = std::vector<std::vector<std::int32_t>>;

std::vector<std::size_t> nearest_neighbors(const Lengths& lengths) {
  std::vector<std::size_t> order{0};
  std::vector<bool> visited(lengths.size(), false);
  visited[0] = true;
  while (order.size() < lengths.size()) {
    std::size_t best = 0;
    for (std::size_t i = 1; i < lengths.size(); ++i) {
      const auto& from = lengths[order.back()];
      if (!visited[i] && (best == 0 || from[i] < from[best])) best = i;
    }
    visited[best] = true;
    order.push_back(best);
  }
  return order;
}

}  // namespace

std::vector<std::size_t> order_of_visits(const Lengths& lengths) {
  std::vector<std::size_t> order = nearest_neighbors(lengths);
  const std::size_t n = order.size();
  for (bool shorter = true; shorter;) {
    shorter = false;
    for (std::size_t i = 0; i + 1 < n; ++i) {
      for (std::size_t j = i + 2; j < n; ++j) {
        const std::size_t a = order[i], b = order[i + 1];
        const std::size_t c = order[j], d = order[(j + 1) % n];
        if (lengths[a][c] + lengths[b][d] >= lengths[a][b] + lengths[c][d]) continue;
        std::reverse(order.begin() + static_cast<std::ptrdiff_t>(i + 1),
                     order.begin() + static_cast<std::ptrdiff_t>(j + 1));
        shorter = true;
      }
    }
  }
  return order;
}

}  // namespace lidarena::flight
