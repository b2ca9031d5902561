// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <thread>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/json_file.hpp"
#include "lidarena/dataset/text_file.hpp"
#include "lidarena/results/run_record.hpp"
#include "lidarena/study/lease.hpp"
#include "lidarena/study/slurm.hpp"
#include "lidarena/study/status.hpp"
#include "lidarena/study/study.hpp"
#include "lidarena/study/workplace.hpp"
#include "tests/study/configs.hpp"
#include "tests/temporary_folder.hpp"

namespace lidarena::study {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::HasSubstr;

/// A room of 12 x 8 x 4 m.
constexpr const char* kRoom =
    "v 0 0 0\nv 12 0 0\nv 0 8 0\nv 12 8 0\nv 0 0 4\nv 12 0 4\nv 0 8 4\nv 12 8 4\n"
    "f 1 2 4 3\nf 5 6 8 7\nf 1 2 6 5\nf 3 4 8 7\nf 1 3 7 5\nf 2 4 8 6\n";
constexpr const char* kFlight =
    "kind: waypoints\nwaypoints: [[2, 2, 1.5], [10, 2, 1.2], [10, 7, 1.8], [2, 2, 1.5]]\n";

/// Studies in that room whose cells are external programs that need no time.
class SharedStudy : public ::testing::Test {
 protected:
  SharedStudy() {
    const fs::path room = scratch_.write("room.obj", kRoom);
    const fs::path flight = scratch_.write("flight.yaml", kFlight);
    spec_.scenes = {{room.string(), flight.string(), 0.3}};
    spec_.sensors = {"livox_mid360"};
    spec_.seeds = {1, 2, 3};
    spec_.external = {external("a", "true"), external("b", "true")};
    for (stages::ExternalProgram& program : spec_.external) program.command = kStill;
    spec_.algorithms = {"a", "b"};
    options_.program = LIDARENA_BINARY;
  }
  static stages::ExternalProgram external(const std::string& name, const std::string& command) {
    stages::ExternalProgram program;
    program.name = name;
    program.command = command;
    return program;
  }
  fs::path out() const { return scratch_.path() / "study"; }
  StudyStatus status() const { return read_status(out()); }
  /// Options of a worker, which has a scratch folder of its own.
  StudyOptions worker(const std::string& name) const {
    StudyOptions options = options_;
    options.scratch = scratch_.path() / name;
    options.waits_for_others = false;
    return options;
  }
  StudyOutcome work(const StudyOptions& options) {
    return work_on_study(out(), configs(), options, log_);
  }
  pid_t work_in_process(const StudyOptions& options) {
    const pid_t child = fork();
    if (child == 0) {
      LogSink silent;
      work_on_study(out(), configs(), options, silent);
      _exit(0);
    }
    return child;
  }

  static constexpr const char* kStill =
      "sh -c 'for t in 0.0 0.1 0.2; do echo $t 0 0 0 0 0 0 1; done > \"$1\"/trajectory.tum' sh "
      "{output}";
  TemporaryFolder scratch_;
  StudySpec spec_;
  StudyOptions options_;
  LogSink log_;
};

/// The files of a study that do not tell times.
std::map<std::string, std::string> study_results_in(const fs::path& study) {
  const std::set<std::string> timed{"resources.csv", "resources.json", "manifest.json",
                                    "lidarena.log",  "request.json",   "program.log"};
  std::map<std::string, std::string> files;
  for (const char* part : {"datasets", "runs", "worlds"}) {
    for (const auto& entry : fs::recursive_directory_iterator(study / part)) {
      if (!entry.is_regular_file() || timed.contains(entry.path().filename())) continue;
      files[entry.path().lexically_relative(study)] = dataset::read_bytes(entry.path());
    }
  }
  return files;
}

TEST_F(SharedStudy, TwoWorkersShareItAndLeaveTheFilesOfALocalRun) {
  run_study(spec_, configs(), scratch_.path() / "local", options_, log_);
  plan_study(spec_, configs(), out(), options_);
  EXPECT_EQ(status().missing, 6U);
  const pid_t other = work_in_process(worker("scratch_of_other"));
  const StudyOutcome mine = work(worker("scratch"));
  waitpid(other, nullptr, 0);
  EXPECT_EQ(status().done, 6U);
  EXPECT_LE(mine.runs, 6U);
  EXPECT_EQ(study_results_in(out()), study_results_in(scratch_.path() / "local"));
  for (const char* folder : {"scratch", "scratch_of_other", "study/work"})
    EXPECT_TRUE(fs::is_empty(scratch_.path() / folder)) << folder;
  EXPECT_EQ(status().workers.size(), 0U);
  EXPECT_EQ(work(worker("scratch")).reused, 6U) << "nothing is left to do";
}

TEST_F(SharedStudy, AWorldIsStoredOnceForAllItsDatasets) {
  run_study(spec_, configs(), out(), options_, log_);
  const auto worlds = fs::directory_iterator(out() / "worlds");
  EXPECT_EQ(std::distance(fs::begin(worlds), fs::end(worlds)), 1);
  for (const char* seed : {"s1", "s2", "s3"}) {
    const fs::path world = out() / "datasets" / (std::string("room-flight-") + seed) / "world.ply";
    EXPECT_TRUE(fs::is_symlink(world));
    EXPECT_GT(fs::file_size(world), 100U);
  }
}

TEST_F(SharedStudy, AWorkerThatIsKilledIsReplacedAndWhatItHadFinishedStays) {
  spec_.external[1].command = "sleep 300";
  plan_study(spec_, configs(), out(), options_);
  const pid_t killed = work_in_process(worker("scratch_of_killed"));
  for (int i = 0; i < 1000 && status().done == 0; ++i) std::this_thread::sleep_for(20ms);
  std::this_thread::sleep_for(200ms);
  const StudyStatus at_work = status();
  kill(killed, SIGKILL);
  waitpid(killed, nullptr, 0);
  EXPECT_EQ(at_work.done, 1U);
  EXPECT_EQ(at_work.running, 1U);
  EXPECT_EQ(at_work.missing, 4U);
  ASSERT_EQ(at_work.workers.size(), 1U);
  EXPECT_THAT(at_work.workers[0].doing, HasSubstr("run room-flight-s1-livox_mid360-b"));
  EXPECT_EQ(status().running, 0U) << "its worker has ended";

  spec_.external[1].command = kStill;
  plan_study(spec_, configs(), out(), options_);
  const StudyOutcome outcome = work(worker("scratch"));
  EXPECT_EQ(outcome.runs, 6U);
  EXPECT_EQ(outcome.reused, 1U);
  EXPECT_TRUE(fs::is_empty(scratch_.path() / "scratch_of_killed"));
}

TEST_F(SharedStudy, AFailedCellIsAResultThatWorkersLeaveAloneUntilTheStudyIsPlannedAgain) {
  const std::string count = (scratch_.path() / "count").string();
  spec_.seeds = {1};
  spec_.external[0].command = "sh -c 'echo x >> " + count + "; echo no such luck >&2; exit 3'";
  plan_study(spec_, configs(), out(), options_);
  EXPECT_EQ(work(worker("scratch")).failed, 1U);
  EXPECT_EQ(work(worker("scratch")).failed, 1U);
  EXPECT_EQ(dataset::read_bytes(count), "x\n");
  const StudyStatus failed = status();
  EXPECT_EQ(failed.done, 1U);
  ASSERT_EQ(failed.failures.size(), 1U);
  EXPECT_THAT(failed.failures[0].reason, HasSubstr("exit code 3"));
  EXPECT_TRUE(fs::exists(failed.failures[0].log));
  plan_study(spec_, configs(), out(), options_);
  EXPECT_EQ(work(worker("scratch")).failed, 1U);
  EXPECT_EQ(dataset::read_bytes(count), "x\nx\n");
}

TEST_F(SharedStudy, AskedToEndItLetsTheRunFinishWithinTheGraceAndGivesUpALongerOne) {
  spec_.seeds = {1};
  const std::string began = (scratch_.path() / "began").string();
  const auto stop_when_it_runs = [&] { return fs::exists(began) ? Stop::kSoon : Stop::kNo; };
  spec_.external[0].command =
      "sh -c 'touch " + began +
      "; sleep 1; for t in 0.0 0.1 0.2; do echo $t 0 0 0 0 0 0 1; done > \"$1\"/trajectory.tum' sh "
      "{output}";
  plan_study(spec_, configs(), out(), options_);
  StudyOptions options = worker("scratch");
  options.stop = stop_when_it_runs;
  EXPECT_TRUE(work(options).is_interrupted);
  EXPECT_EQ(status().done, 0U) << "no time of grace";
  EXPECT_TRUE(fs::is_empty(scratch_.path() / "scratch"));
  EXPECT_EQ(status().workers.size(), 0U);
  fs::remove(began);
  options.grace_s = 60.0;
  const StudyOutcome outcome = work(options);
  EXPECT_TRUE(outcome.is_interrupted);
  EXPECT_TRUE(outcome.has_advanced);
  EXPECT_EQ(status().done, 1U) << "the second cell is not begun";
  options.stop = {};
  EXPECT_FALSE(work(options).is_interrupted);
  EXPECT_EQ(status().done, 2U);
}

TEST_F(SharedStudy, AnotherStudyInTheFolderIsRefusedWhileWorkersAreBusyAndTheSameOneJoins) {
  spec_.seeds = {1};
  const std::string release = (scratch_.path() / "go").string();
  const std::string began = (scratch_.path() / "began").string();
  spec_.external[0].command =
      "sh -c 'touch " + began + "; while [ ! -e " + release + " ]; do sleep 0.05; done; exit 1'";
  plan_study(spec_, configs(), out(), options_);
  const pid_t other = work_in_process(worker("scratch"));
  while (!fs::exists(began)) std::this_thread::sleep_for(20ms);
  StudySpec different = spec_;
  different.seeds = {7};
  EXPECT_THROW(plan_study(different, configs(), out(), options_), InputError);
  EXPECT_EQ(plan_study(spec_, configs(), out(), options_).attempt, 1);
  std::thread([&] {
    std::this_thread::sleep_for(500ms);
    std::ofstream{release};
  }).detach();
  const StudyOutcome joined = run_study(spec_, configs(), out(), options_, log_);
  EXPECT_EQ(joined.runs, 2U) << "it waits for the other one's unit";
  EXPECT_EQ(joined.failed, 1U);
  waitpid(other, nullptr, 0);
}

TEST_F(SharedStudy, ShardsOfAPlanAreThoseOfItsFirstCallAndTogetherAllOfIt) {
  StudyOptions part = options_;
  part.shard = {1, 2};
  const StudyOutcome first = run_study(spec_, configs(), out(), part, log_);
  EXPECT_EQ(first.cells, first.runs);
  EXPECT_LT(first.cells, 6U);
  part.shard = {2, 3};
  EXPECT_THROW(run_study(spec_, configs(), out(), part, log_), InputError);
  part.shard = {2, 2};
  EXPECT_EQ(run_study(spec_, configs(), out(), part, log_).cells + first.cells, 6U);
  EXPECT_EQ(status().done, 6U);
}

TEST_F(SharedStudy, RunsThatNeverCameAreMissingInTheReport) {
  plan_study(spec_, configs(), out(), options_);
  const results::StudyResults planned = results::read_results(out());
  EXPECT_TRUE(planned.rows.empty());
  ASSERT_EQ(planned.without_result.size(), 6U);
  for (const results::RunRecord& run : planned.without_result)
    EXPECT_EQ(run.status, "missing") << run.name;
  // A part of the study in another folder fills them.
  StudyOptions part = options_;
  part.shard = {1, 2};
  run_study(spec_, configs(), scratch_.path() / "part", part, log_);
  const results::StudyResults merged =
      results::merged({planned, results::read_results(scratch_.path() / "part")});
  const std::size_t done = read_status(scratch_.path() / "part").done;
  EXPECT_EQ(merged.rows.size(), done);
  EXPECT_EQ(merged.without_result.size(), 6U - done);
}

TEST_F(SharedStudy, ATornPlanOrRequestIsNotTakenForAWholeOne) {
  spec_.seeds = {1};
  run_study(spec_, configs(), out(), options_, log_);
  const fs::path request = out() / "runs/room-flight-s1-livox_mid360-a-external/request.json";
  fs::resize_file(request, fs::file_size(request) / 2);
  EXPECT_EQ(status().missing, 1U);
  EXPECT_EQ(run_study(spec_, configs(), out(), options_, log_).reused, 1U);
  fs::resize_file(out() / "plan.json", 100);
  EXPECT_THROW(status(), InputError);
  EXPECT_THROW(work(worker("scratch")), InputError);
  EXPECT_THROW(read_status(scratch_.path() / "nothing"), InputError);
  EXPECT_EQ(run_study(spec_, configs(), out(), options_, log_).reused, 2U) << "it is planned again";
}

TEST_F(SharedStudy, ANodeWithOtherConfigurationsIsRefused) {
  plan_study(spec_, configs(), out(), options_);
  std::ofstream(scratch_.path() / "flight.yaml", std::ios::app) << "# changed\n";
  EXPECT_THROW(work(worker("scratch")), InputError);
  EXPECT_EQ(status().workers.size(), 0U) << "its lease must not remain";
}

TEST_F(SharedStudy, AFolderIsPublishedWholeAndReplacesAnOlderOne) {
  const fs::path study = out();
  for (const fs::path& scratch : {fs::path(), scratch_.path() / "disk"}) {
    const Workplace place(study, scratch, "token");
    for (const char* content : {"old", "new"}) {
      fs::create_directories(place.root() / "runs/r/sub");
      std::ofstream(place.root() / "runs/r/sub/file") << content;
      place.publish_run("r");
      EXPECT_FALSE(fs::exists(place.root() / "runs/r"));
    }
    EXPECT_EQ(dataset::read_bytes(study / "runs/r/sub/file"), "new");
  }
  EXPECT_TRUE(fs::is_empty(study / "work"));
}

TEST_F(SharedStudy, TheBatchScriptsNameTheStudyAndTheOptions) {
  const StudyPlan plan = plan_study(spec_, configs(), out(), options_);
  SlurmOptions cluster;
  cluster.partition = "long";
  cluster.time = "1:00:00";
  cluster.cpus = 4;
  cluster.sbatch = {"--account=robots"};
  const SlurmJobs jobs = write_slurm_jobs(plan, out(), LIDARENA_BINARY, cluster);
  const std::string tasks = dataset::read_bytes(jobs.tasks);
  EXPECT_THAT(tasks, AllOf(HasSubstr("--array=1-3\n"), HasSubstr("--cpus-per-task=4\n"),
                           HasSubstr("--partition=long\n"), HasSubstr("--time=1:00:00\n"),
                           HasSubstr("#SBATCH --account=robots\n"), HasSubstr("--signal=B:USR1@")));
  EXPECT_THAT(tasks, HasSubstr("study --worker --out '" + fs::canonical(out()).string() + "'"));
  EXPECT_EQ(std::system(("bash -n " + jobs.tasks.string()).c_str()), 0);
  cluster.array_limit = 2;
  EXPECT_THAT(dataset::read_bytes(write_slurm_jobs(plan, out(), LIDARENA_BINARY, cluster).tasks),
              HasSubstr("--array=1-2\n"));
}

}  // namespace
}  // namespace lidarena::study
