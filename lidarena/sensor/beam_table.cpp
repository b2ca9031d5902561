// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/sensor/beam_table.hpp"

#include <algorithm>

namespace lidarena::sensor {

BeamTable::BeamTable(const ScanPattern& pattern) : pattern_(pattern) {
  pattern.beams(0, first_);
  const std::uint64_t scans = pattern.repeats_after();
  const std::uint64_t bytes = scans * first_.size() * sizeof(Eigen::Vector3f);
  if (scans > 1 && bytes <= kMaxBytes) slots_ = std::vector<Slot>(scans);
}

std::size_t BeamTable::bytes() const {
  return first_.size() * (sizeof(Beam) + slots_.size() * sizeof(Eigen::Vector3f));
}

bool BeamTable::differs_only_in_directions(const std::vector<Beam>& beams) const {
  return std::ranges::equal(beams, first_, [](const Beam& a, const Beam& b) {
    return a.dt_ns == b.dt_ns && a.ring == b.ring && a.origin == b.origin;
  });
}

std::span<const Beam> BeamTable::beams(std::uint64_t index, std::vector<Beam>& storage) const {
  if (pattern_.repeats_after() == 1) return first_;
  if (slots_.empty()) {
    pattern_.beams(index, storage);
    return storage;
  }
  Slot& slot = slots_[index % slots_.size()];
  std::call_once(slot.once, [&] {
    pattern_.beams(index, storage);
    if (!differs_only_in_directions(storage)) return;  // not stored: computed on every call
    slot.directions.reserve(storage.size());
    for (const Beam& beam : storage) slot.directions.push_back(beam.direction);
  });
  if (slot.directions.empty()) {
    pattern_.beams(index, storage);
    return storage;
  }
  storage = first_;
  for (std::size_t i = 0; i < storage.size(); ++i) storage[i].direction = slot.directions[i];
  return storage;
}

}  // namespace lidarena::sensor
