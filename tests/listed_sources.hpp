// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <optional>
#include <utility>
#include <vector>

#include "lidarena/base/event.hpp"
#include "lidarena/base/point_truth.hpp"

/// Sources that return the items that a test has put into a list.
namespace lidarena::listed {

/// Removes and returns the first of `items`; empty when there is none.
template <class Item>
std::optional<Item> take_first(std::deque<Item>& items) {
  if (items.empty()) return std::nullopt;
  Item item = std::move(items.front());
  items.pop_front();
  return item;
}

class Truths : public ScanTruthSource {
 public:
  std::optional<ScanTruth> next() override { return take_first(scans); }
  std::deque<ScanTruth> scans;
};

class Events : public EventSource {
 public:
  Events() = default;
  explicit Events(const std::vector<Event>& list) : events(list.begin(), list.end()) {}
  std::optional<Event> next() override { return take_first(events); }
  std::deque<Event> events;
};

}  // namespace lidarena::listed
