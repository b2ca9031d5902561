// SPDX-License-Identifier: BSD-3-Clause
#include "lidarena/study/lease.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>
#include <functional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "lidarena/dataset/json_file.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::study {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

constexpr LeaseTimes kFast{20ms, 400ms};

/// Runs `work` in a process of its own, without the destructors of this one.
pid_t in_process(const std::function<void()>& work) {
  const pid_t child = fork();
  if (child == 0) {
    work();
    _exit(0);
  }
  return child;
}

void wait_for(pid_t child) { waitpid(child, nullptr, 0); }

/// Starts a process that takes the unit and holds it until it is killed.
pid_t holder_of(const fs::path& folder, const std::string& unit, LeaseTimes times) {
  const pid_t child = in_process([&] {
    Leases leases(folder, "", times);
    leases.take(unit);
    pause();
  });
  while (!fs::exists(folder / unit)) std::this_thread::sleep_for(1ms);
  return child;
}

/// Leases that `processes` processes have got when all of them tried to take each of `units`.
std::vector<std::string> taken_in_race(const fs::path& folder, int processes,
                                       const std::vector<std::string>& units, LeaseTimes times) {
  const fs::path got = folder / "got";
  const fs::path start = folder / "start";
  std::vector<pid_t> racers;
  for (int i = 0; i < processes; ++i) {
    racers.push_back(in_process([&] {
      Leases leases(folder / "leases", "", times);
      while (!fs::exists(start)) {
      }
      std::string mine;
      for (const std::string& unit : units) mine += leases.take(unit) ? unit + "\n" : "";
      std::ofstream(got.string() + std::to_string(getpid())) << mine;
      while (!fs::exists(folder / "end")) std::this_thread::sleep_for(5ms);
    }));
  }
  std::this_thread::sleep_for(50ms);
  std::ofstream(start) << "go";
  std::vector<std::string> taken;
  for (const pid_t racer : racers) {
    const fs::path file = got.string() + std::to_string(racer);
    while (!fs::exists(file)) std::this_thread::sleep_for(5ms);
  }
  std::this_thread::sleep_for(20ms);
  for (const pid_t racer : racers) {
    std::ifstream file(got.string() + std::to_string(racer));
    for (std::string unit; std::getline(file, unit);) taken.push_back(unit);
  }
  std::ofstream(folder / "end") << "end";
  for (const pid_t racer : racers) wait_for(racer);
  return taken;
}

std::vector<std::string> forty_units() {
  std::vector<std::string> units;
  for (int i = 0; i < 40; ++i) units.push_back("unit" + std::to_string(i));
  return units;
}

TEST(Leases, OfProcessesThatRaceForUnitsExactlyOneGetsEach) {
  const TemporaryFolder scratch;
  const std::vector<std::string> units = forty_units();
  std::vector<std::string> taken = taken_in_race(scratch.path(), 6, units, {});
  EXPECT_EQ(taken.size(), units.size());
  EXPECT_EQ(std::set<std::string>(taken.begin(), taken.end()).size(), units.size());
}

TEST(Leases, OfProcessesThatFindTheLeasesOfADeadOneExactlyOneTakesEachOver) {
  const TemporaryFolder scratch;
  const std::vector<std::string> units = forty_units();
  const pid_t dead = in_process([&] {
    Leases leases(scratch.path() / "leases");
    for (const std::string& unit : units) leases.take(unit);
    kill(getpid(), SIGKILL);
  });
  wait_for(dead);
  ASSERT_EQ(all_leases(scratch.path() / "leases").size(), units.size());
  const std::vector<std::string> taken = taken_in_race(scratch.path(), 6, units, {});
  EXPECT_EQ(taken.size(), units.size());
  EXPECT_EQ(std::set<std::string>(taken.begin(), taken.end()).size(), units.size());
}

TEST(Leases, TheLeaseOfALivingProcessIsNotTakenHoweverLongItWorks) {
  const TemporaryFolder scratch;
  const pid_t holder = holder_of(scratch.path(), "unit", kFast);
  Leases leases(scratch.path(), "", kFast);
  std::this_thread::sleep_for(3 * kFast.stale);
  EXPECT_FALSE(leases.take("unit"));
  EXPECT_FALSE(leases.look("unit")->dead);
  kill(holder, SIGKILL);
  wait_for(holder);
}

TEST(Leases, TheLeaseOfAKilledProcessOfThisMachineIsTakenOverAtOnce) {
  const TemporaryFolder scratch;
  const pid_t holder = holder_of(scratch.path(), "unit", {});
  Leases leases(scratch.path());
  EXPECT_FALSE(leases.take("unit"));
  kill(holder, SIGKILL);
  wait_for(holder);
  const auto taken = leases.take("unit");
  ASSERT_TRUE(taken);
  EXPECT_EQ(taken->taken_from.value().process, holder);
  EXPECT_TRUE(leases.holds("unit"));
}

TEST(Leases, OneOfAnotherMachineIsTakenOverWhenItsOwnerHasBeenSilentAndThatOneNotices) {
  const TemporaryFolder scratch;
  const pid_t holder = holder_of(scratch.path(), "unit", kFast);
  // The suspended process stands for one on a machine that is cut off: it exists, but is silent.
  kill(holder, SIGSTOP);
  Leases leases(scratch.path(), "", kFast);
  EXPECT_FALSE(leases.take("unit")) << "it was heard just before";
  std::this_thread::sleep_for(2 * kFast.stale);
  ASSERT_TRUE(leases.take("unit"));
  kill(holder, SIGCONT);
  std::this_thread::sleep_for(10 * kFast.heartbeat);
  EXPECT_TRUE(leases.holds("unit"));
  kill(holder, SIGTERM);
  wait_for(holder);
}

TEST(Leases, AProcessWhoseLeaseWasTakenOverKnowsAndLeavesTheNewOneAlone) {
  const TemporaryFolder scratch;
  Leases mine(scratch.path());
  ASSERT_TRUE(mine.take("unit"));
  Json other = dataset::read_json(scratch.path() / "unit");
  other["token"] = "of-another-process";
  dataset::write_json(scratch.path() / "unit", other);
  EXPECT_FALSE(mine.holds("unit"));
  mine.release("unit");
  EXPECT_TRUE(fs::exists(scratch.path() / "unit"));
}

TEST(Leases, ATornLeaseIsTakenOverOnceItIsOld) {
  const TemporaryFolder scratch;
  const fs::path file = scratch.write("unit", "{\"token\": \"hal");
  Leases leases(scratch.path(), "", kFast);
  EXPECT_FALSE(leases.take("unit"));
  fs::last_write_time(file, fs::last_write_time(file) - 1h);
  EXPECT_TRUE(leases.take("unit"));
  EXPECT_TRUE(leases.holds("unit"));
}

TEST(Leases, AnEarlierStartOfTheSameSlurmJobIsDead) {
  const TemporaryFolder scratch;
  const auto write_lease = [&](const char* job) {
    dataset::write_json(scratch.path() / "unit", {{"token", "first"},
                                                  {"host", "n1"},
                                                  {"machine", "n1"},
                                                  {"process", 1},
                                                  {"job", job},
                                                  {"restart", 0},
                                                  {"scratch", ""},
                                                  {"since", 0.0}});
  };
  setenv("SLURM_JOB_ID", "17", 1);
  setenv("SLURM_RESTART_COUNT", "1", 1);
  Leases leases(scratch.path());
  unsetenv("SLURM_JOB_ID");
  unsetenv("SLURM_RESTART_COUNT");
  write_lease("16");
  EXPECT_FALSE(leases.take("unit"));
  write_lease("17");
  EXPECT_TRUE(leases.take("unit"));
}

TEST(Leases, ReleasedAndAtTheEndTheyLeaveNoFiles) {
  const TemporaryFolder scratch;
  {
    Leases leases(scratch.path());
    ASSERT_TRUE(leases.take("a"));
    ASSERT_TRUE(leases.take("b"));
    EXPECT_FALSE(Leases(scratch.path()).take("a")) << "another object of the same process";
    leases.release("a");
    EXPECT_EQ(all_leases(scratch.path()).size(), 1U);
  }
  for (const auto& entry : fs::directory_iterator(scratch.path()))
    EXPECT_EQ(entry.path().filename(), ".clock");
}

}  // namespace
}  // namespace lidarena::study
