// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/map/hash_order.hpp"

#include <utility>

namespace lidarena::map {
namespace {

constexpr std::uint32_t kFree = 0xFFFFFFFFU;

/// An item in the table.
struct Placed {
  std::uint32_t index = kFree;
  std::uint32_t wanted_slot = 0;
};

/// From its wanted slot on, an item takes the first slot that is free or whose item is nearer to
/// its own wanted slot; that one moves on.
void place(Placed moving, std::vector<Placed>& table) {
  const auto mask = static_cast<std::uint32_t>(table.size() - 1);
  std::uint32_t slot = moving.wanted_slot;
  const auto distance = [&](const Placed& placed) { return (slot - placed.wanted_slot) & mask; };
  for (; table[slot].index != kFree; slot = (slot + 1) & mask) {
    if (distance(moving) > distance(table[slot])) std::swap(moving, table[slot]);
  }
  table[slot] = moving;
}

}  // namespace

std::vector<std::uint32_t> robin_hood_order(std::span<const std::uint32_t> hashes,
                                            std::size_t slots) {
  const auto mask = static_cast<std::uint32_t>(slots - 1);
  std::vector<Placed> table(slots);
  for (std::uint32_t i = 0; i < hashes.size(); ++i) place({i, hashes[i] & mask}, table);
  std::vector<std::uint32_t> order;
  order.reserve(hashes.size());
  for (const Placed& placed : table) {
    if (placed.index != kFree) order.push_back(placed.index);
  }
  return order;
}

}  // namespace lidarena::map
