// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/study/unit_queue.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace lidarena::study {
namespace {

namespace fs = std::filesystem;

constexpr auto kScanPeriod = std::chrono::seconds(1);  ///< between looks at the leases of others
/// A lease untouched for this long may be that of a dead process: worth waiting for.
constexpr double kSuspiciousSilence_s = 15.0;

}  // namespace

UnitQueue::UnitQueue(const StudyPlan& plan, const stages::ConfigFolder& configs,
                     const fs::path& study, const StudyOptions& options, LogSink& log)
    : plan_(plan),
      configs_(configs),
      study_(study),
      options_(options),
      log_(log),
      leases_(study / "leases", options.scratch.string()),
      published_(plan, study) {
  for (const std::size_t i : units_of(plan, options.shard)) {
    todo_.push_back(&plan.units[i]);
    seconds_of_all_ += plan.units[i].seconds;
  }
}

/// Cells of a unit that have no state yet, of those that the study's folder holds.
std::vector<std::size_t> UnitQueue::open_cells(const PlanUnit& unit) const {
  std::vector<std::size_t> open;
  for (const std::size_t cell : unit.cells) {
    const TaskResult result = published_.run(unit, cell).result();
    const bool has_state = result.state == TaskState::kFailed ? result.attempt == plan_.attempt
                                                              : result.state != TaskState::kMissing;
    if (!has_state) open.push_back(cell);
  }
  return open;
}

bool UnitQueue::open_next() {
  if (next_scan_ > Clock::now()) return false;
  for (auto next = todo_.begin(); next != todo_.end();) {
    const PlanUnit& unit = **next;
    if (open_cells(unit).empty()) {
      seconds_of_all_ -= unit.seconds;  // what others did tells nothing about this worker
      next = todo_.erase(next);
      continue;
    }
    const bool has_room = has_room_for(unit);
    if (!has_room && !open_.empty()) break;
    const std::optional<Leases::Taken> taken = leases_.take(unit.dataset);
    if (taken) {
      next = todo_.erase(next);
      open(unit, *taken, has_room);
      return true;
    }
    ++next;
  }
  next_scan_ = Clock::now() + kScanPeriod;
  has_scanned_ = true;
  return false;
}

void UnitQueue::open(const PlanUnit& unit, const Leases::Taken& taken, bool has_room) {
  if (const auto& dead = taken.taken_from) {
    log_.info(fmt::format("{} is taken over from process {} on {}, which has ended", unit.dataset,
                          dead->process, dead->host));
    clear_workplace(study_, dead->scratch, dead->token);
  }
  if (flight_key(plan_, unit, configs_) != unit.flight) {
    leases_.release(unit.dataset);
    throw InputError(configs_.root().string(),
                     "differs, here, from the files with which " + unit.dataset + " was planned",
                     "plan the study again, or install the same files on all machines");
  }
  open_.push_back(std::make_shared<OpenUnit>(unit, plan_, study_, options_.scratch, taken.token));
  OpenUnit& opened = *open_.back();
  opened.keeps_data = has_room;
  opened.has_flown = !plan_.cells[unit.cells.front()].recording.empty();
  for (const std::size_t cell : open_cells(unit)) {
    opened.waiting.push_back(opened.tasks.run(unit, cell));
    if (published_.run(unit, cell).first_open_step() > 0)
      opened.place.fetch_run(plan_.cells[cell].name);
    seconds_of_all_ += plan_.seconds[cell];
  }
  seconds_of_all_ -= unit.seconds;
  if (opened.waiting.empty()) close_finished();  // its last owner had just finished
}

/// Whether the measurements of one more dataset fit on the disk.
bool UnitQueue::has_room_for(const PlanUnit& unit) const {
  std::uint64_t held = 0, coming = 0;
  for (const auto& other : open_) {
    const std::uint64_t bytes = other->place.data_bytes(other->unit.dataset);
    if (other->keeps_data && bytes == 0) coming += other->unit.data_bytes;
    held += bytes;
  }
  if (options_.scratch_bytes) return held + coming + unit.data_bytes <= *options_.scratch_bytes;
  const fs::path& disk = options_.scratch.empty() ? study_ : options_.scratch;
  return coming + unit.data_bytes <= default_scratch_bytes(disk);
}

void UnitQueue::close_finished() {
  std::erase_if(open_, [&](std::shared_ptr<OpenUnit>& unit) {
    if (!unit->waiting.empty() || unit->running > 0) return false;
    const std::string dataset = unit->unit.dataset;
    unit.reset();
    leases_.release(dataset);
    next_scan_ = Clock::now();
    return true;
  });
}

void UnitQueue::give_up() {
  while (!open_.empty()) {
    const std::string dataset = open_.back()->unit.dataset;
    open_.pop_back();
    leases_.release(dataset);
  }
}

bool UnitQueue::is_finished() {
  if (!open_.empty()) return false;
  if (todo_.empty()) return true;
  if (!std::exchange(has_scanned_, false)) return false;
  if (options_.waits_for_others) return tell_waiting(), false;
  const bool leaves = std::ranges::none_of(todo_, [&](const PlanUnit* unit) {
    const std::optional<LeaseSeen> lease = leases_.look(unit->dataset);
    return !lease || lease->silent_s > kSuspiciousSilence_s;
  });
  if (leaves) todo_.clear();
  return leaves;
}

void UnitQueue::tell_waiting() {
  if (std::exchange(has_told_waiting_, true)) return;
  log_.info(fmt::format("waiting for other processes that work on {} datasets", todo_.size()));
}

}  // namespace lidarena::study
