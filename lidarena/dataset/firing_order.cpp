// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/dataset/firing_order.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <utility>

namespace lidarena::dataset {
namespace {

/// A point's time since the earliest point, and its index.
struct Key {
  std::uint32_t time;
  std::uint32_t index;
};

/// Kept from scan to scan, because new memory costs more than sorting.
struct Scratch {
  std::vector<Key> keys, sorted;
  std::vector<Point> points;
};

constexpr int kDigitBits = 14;  // two passes cover 0.27 s
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
  static thread_local Scratch scratch;
  auto& [keys, sorted, unsorted] = scratch;
  const auto [first, last] = std::ranges::minmax(points, {}, &Point::dt_ns);
  const auto since_first = [from = std::int64_t{first.dt_ns}](const Point& point) {
    return static_cast<std::uint32_t>(point.dt_ns - from);
  };
  const int bits = std::bit_width(since_first(last));
  keys.resize(points.size());
  sorted.resize(points.size());
  for (std::uint32_t i = 0; i < points.size(); ++i) keys[i] = {since_first(points[i]), i};
  for (int shift = 0; shift < bits; shift += kDigitBits) {
    sort_by_digit(keys, shift, sorted);
    keys.swap(sorted);
  }
  unsorted = points;
  for (std::size_t i = 0; i < points.size(); ++i) points[i] = unsorted[keys[i].index];
}

}  // namespace lidarena::dataset
