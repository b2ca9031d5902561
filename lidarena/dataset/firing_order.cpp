// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/firing_order.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

namespace lidarena::dataset {
namespace {

/// A point's time, moved so that it is not negative, and its index.
struct Key {
  std::uint32_t time;
  std::uint32_t index;
};

constexpr int kDigitBits = 11;  // three passes cover 33 bits; the counters fit into the L1 cache
constexpr std::size_t kDigits = std::size_t{1} << kDigitBits;

/// One pass of a radix sort (least significant digit first): sorts by the bits from `shift` on.
void sort_by_digit(const std::vector<Key>& keys, int shift, std::vector<Key>& sorted) {
  const auto digit = [shift](const Key& key) { return (key.time >> shift) & (kDigits - 1); };
  std::array<std::uint32_t, kDigits> next{};  // number of keys of a digit, then their next place
  for (const Key& key : keys) ++next[digit(key)];
  std::uint32_t begin = 0;
  for (std::uint32_t& place : next) begin += std::exchange(place, begin);
  for (const Key& key : keys) sorted[next[digit(key)]++] = key;
}

}  // namespace

void sort_in_firing_order(std::vector<Point>& points) {
  if (std::ranges::is_sorted(points, {}, &Point::dt_ns)) return;
  std::vector<Key> keys(points.size());
  for (std::uint32_t i = 0; i < points.size(); ++i)
    keys[i] = {static_cast<std::uint32_t>(points[i].dt_ns) ^ 0x80000000U, i};
  std::vector<Key> sorted(points.size());
  for (int shift = 0; shift < 32; shift += kDigitBits) {
    sort_by_digit(keys, shift, sorted);
    keys.swap(sorted);
  }
  std::vector<Point> ordered;
  ordered.reserve(points.size());
  for (const Key& key : keys) ordered.push_back(points[key.index]);
  points = std::move(ordered);
}

}  // namespace lidarena::dataset
