// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <deque>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "lidarena/base/log.hpp"
#include "lidarena/study/lease.hpp"
#include "lidarena/study/study.hpp"
#include "lidarena/study/tasks.hpp"
#include "lidarena/study/workplace.hpp"

namespace lidarena::study {

/// A leased unit.
struct OpenUnit {
  OpenUnit(const PlanUnit& planned, const StudyPlan& plan, const std::filesystem::path& study,
           const std::filesystem::path& scratch, const std::string& token)
      : unit(planned), place(study, scratch, token), tasks(plan, place.root()) {}

  const PlanUnit& unit;
  Workplace place;
  Tasks tasks;
  std::deque<Task> waiting;  ///< cells to run or to score
  bool keeps_data = true;    ///< false: its dataset is simulated anew for each run
  bool is_flying = false, has_flown = false;
  int running = 0;
};

/// The units that a worker has leased, and those that it may lease.
class UnitQueue {
 public:
  /// The arguments must outlive this.
  UnitQueue(const StudyPlan& plan, const stages::ConfigFolder& configs,
            const std::filesystem::path& study, const StudyOptions& options, LogSink& log);

  /// The leased units that are not done.
  const std::vector<std::shared_ptr<OpenUnit>>& open() const { return open_; }
  /// Leases the first unit with work that nobody has; false if there is none, or no room for it.
  /// Throws InputError if the configuration files are not those of the plan.
  bool open_next();
  /// Whether the unit is still this worker's: another one may have taken it for dead.
  bool holds(const OpenUnit& unit) const { return leases_.holds(unit.unit.dataset); }
  /// Deletes the folders of finished units, and releases them.
  void close_finished();
  /// The same with all units, finished or not.
  void give_up();
  bool has_work() const { return !open_.empty() || !todo_.empty(); }
  /// Whether this worker may leave: nothing is left, or others are at work on all of it. A worker
  /// for the whole study waits for them, any other only while one of them may be dead.
  bool is_finished();

  /// Expected seconds of the work of this worker, without what others did.
  double seconds_of_all() const { return seconds_of_all_; }
  double seconds_done() const { return seconds_done_; }
  void count_done(double expected_seconds) { seconds_done_ += expected_seconds; }

 private:
  void open(const PlanUnit& unit, const Leases::Taken& taken, bool has_room);
  std::vector<std::size_t> open_cells(const PlanUnit& unit) const;
  bool has_room_for(const PlanUnit& unit) const;
  void tell_waiting();

  using Clock = std::chrono::steady_clock;

  const StudyPlan& plan_;
  const stages::ConfigFolder& configs_;
  const std::filesystem::path study_;
  const StudyOptions& options_;
  LogSink& log_;
  Leases leases_;    // outlives the units, whose folders are deleted before their leases
  Tasks published_;  // in the study's folder
  std::vector<std::shared_ptr<OpenUnit>> open_;
  std::deque<const PlanUnit*> todo_;
  Clock::time_point next_scan_ = Clock::now();
  bool has_scanned_ = false;  ///< since it was last asked whether the worker is finished
  bool has_told_waiting_ = false;
  double seconds_of_all_ = 0.0, seconds_done_ = 0.0;
};

}  // namespace lidarena::study
