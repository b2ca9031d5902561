// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

/// What several of the report's tables are made with.
namespace lidarena::report {

inline std::string names_text(const std::vector<std::string>& names) {
  return names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "));
}

/// The items of each world and figure, in their order. Valid as long as `items`.
template <class Item>
std::vector<std::vector<const Item*>> by_world_and_figure(const std::vector<Item>& items) {
  std::vector<std::vector<const Item*>> groups;
  for (const Item& item : items) {
    const auto group = std::ranges::find_if(groups, [&](const auto& g) {
      return g.front()->world == item.world && g.front()->figure == item.figure;
    });
    if (group != groups.end())
      group->push_back(&item);
    else
      groups.push_back({&item});
  }
  return groups;
}

}  // namespace lidarena::report
