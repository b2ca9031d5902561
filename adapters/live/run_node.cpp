// SPDX-License-Identifier: BSD-3-Clause
#include "adapters/live/run_node.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <optional>
#include <set>

#include "adapters/live/interrupt.hpp"
#include "adapters/live/player.hpp"
#include "adapters/live/pose_record.hpp"
#include "lidarena/base/error.hpp"
#include "lidarena/stages/foreign_program.hpp"

namespace lidarena::live {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

constexpr int kDomains = 101;  // 1 to 101: their ports are not among those that programs are given
constexpr auto kSettled = milliseconds(1000);  // nothing came for so long after the last scan
constexpr auto kSettleLimit = milliseconds(10'000);
constexpr auto kGrace = milliseconds(10'000);     // for the node, from Ctrl-C to its end
constexpr auto kShortGrace = milliseconds(2000);  // the same where its results do not matter

/// A DDS domain that no other run of this machine has while this object exists.
class OwnDomain {
 public:
  OwnDomain() {
    for (int i = 0; i < kDomains && file_ < 0; ++i) {
      number_ = 1 + (static_cast<int>(getpid()) + i) % kDomains;
      const fs::path lock = fs::temp_directory_path() / fmt::format("lidarena-domain-{}", number_);
      file_ = ::open(lock.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
      if (file_ >= 0 && flock(file_, LOCK_EX | LOCK_NB) != 0) {
        ::close(file_);
        file_ = -1;
      }
    }
    if (file_ < 0) throw Error("all DDS domains from 1 to 101 are used by other runs");
  }
  ~OwnDomain() { ::close(file_); }
  OwnDomain(const OwnDomain&) = delete;
  OwnDomain& operator=(const OwnDomain&) = delete;
  int number() const { return number_; }

 private:
  int number_ = 0;
  int file_ = -1;
};

/// The running node.
class Node {
 public:
  Node(const stages::ExternalProgram& program, const std::string& command, const fs::path& log)
      : name_(program.name), process_(stages::shell_command(command, log)) {}

  ~Node() {
    if (!end_) process_.stop(kShortGrace);
  }
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;

  /// Throws Error if it has ended.
  void check() {
    if (!end_) end_ = process_.poll();
    if (!end_) return;
    throw Error(fmt::format(
        "{} ended before the data did, with {}; its output is in {}", name_,
        end_->exit_code < 0 ? end_->reason : fmt::format("exit code {}", end_->exit_code),
        stages::kProgramLog));
  }
  stages::ProcessEnd stop() {
    if (!end_) end_ = process_.stop(kGrace);
    return *end_;
  }

 private:
  std::string name_;
  stages::Process process_;
  std::optional<stages::ProcessEnd> end_;
};

/// What the node got and gave.
struct Fed {
  PoseRecord::Result result;
  Json messages;  ///< counts
  std::size_t unanswered = 0;
  double longest_answer_s = 0.0;
  double seconds = 0.0;
  stages::ProcessEnd end;
};

void check_program(const stages::ExternalProgram& program) {
  if (program.input == dataset::DatasetFormat::kMcap) return;
  throw InputError(program.name, "is a ROS 2 node and cannot be given another input than mcap",
                   "remove the key 'input'");
}

std::set<std::string> result_topics(const stages::NodeTopics& node) {
  std::set<std::string> topics{node.odometry, node.path, node.points};
  topics.erase("");
  return topics;
}

Fed feed_node(const stages::ExternalProgram& program, const stages::ProgramInput& recording,
              const std::string& command, const fs::path& log_file, LogSink& log) {
  const stages::NodeTopics& topics = program.node;
  const OwnDomain domain;
  const dds::LiveOptions live{.domain = domain.number()};
  setenv("ROS_DOMAIN_ID", std::to_string(domain.number()).c_str(), 1);
  PoseRecord poses(ResultTopics{topics.odometry, topics.path, topics.points});
  const auto interrupted = end_on_interrupt();
  const auto begin = std::chrono::steady_clock::now();
  Node node(program, command, log_file);
  const auto stopped = [&] {
    if (interrupted()) throw Error("interrupted");
    node.check();
    return false;
  };
  Answers answers(live, topics.answer(), result_topics(topics),
                  [&poses](const dataset::RecordedMessage& message) { poses.add(message); });
  NodeFeed feed({.answer = topics.answer(),
                 .lock_step = topics.rate == 0.0,
                 .answer_limit_s = topics.answer_limit_s,
                 .start_limit_s = topics.start_limit_s},
                answers, stopped);
  PacedWriter out(live, {.rate = topics.rate}, stopped, &feed, scan_topic_of(recording.path, {}));
  play_recording(recording.path, out, stopped, log);
  out.close();
  answers.settle(kSettled, kSettleLimit);
  Fed fed;
  fed.end = node.stop();
  fed.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  answers.stop();
  fed.messages = out.summary();
  fed.messages["lost"] = answers.lost();
  fed.messages["bad"] = poses.bad();
  fed.unanswered = feed.unanswered();
  fed.longest_answer_s = fed.messages.value("answer_max_s", 0.0);
  log.info(program.name + " got " + out.summary_text());
  fed.result = poses.take(log);
  return fed;
}

}  // namespace

odometry::RunSummary run_node(const stages::ExternalProgram& program,
                              const stages::RunRequest& request, const fs::path& out,
                              const Parallel& parallel, LogSink& log) {
  check_program(program);
  const fs::path input = out / stages::kProgramInput, output = out / stages::kProgramOutput;
  for (const fs::path& stale : {input, output}) fs::remove_all(stale);
  fs::create_directories(output);
  log.info("recording for " + program.name);
  const stages::ProgramInput recording = stages::record_for(program, request, input, parallel);
  log.info("running " + program.name);
  const Fed fed =
      feed_node(program, recording, stages::command_line(program, recording, output, parallel),
                out / stages::kProgramLog, log);
  fs::remove_all(input);
  stages::ForeignRun run;
  run.name = program.name;
  run.pose_of = program.pose_of;
  run.trajectory = stages::at_flight_times(program, fed.result.trajectory, recording.spans);
  run.live = stages::at_flight_times(program, fed.result.live, recording.spans);
  run.map.points = fed.result.map;
  run.events = recording.events.events(recording.first_scan.value_or(Time{0}));
  run.summary.scans = recording.scans;
  run.summary.dropped = fed.unanswered;
  run.summary.longest_delay_s = fed.longest_answer_s;
  run.summary.sensor_seconds = recording.seconds;
  run.summary.compute_seconds = fed.seconds;
  run.preset = "external";
  run.config = to_json(program);
  run.on_live_topics = true;
  run.messages = fed.messages;
  run.process = {fed.end.processor_s, fed.end.peak_mb};
  stages::write_foreign_run(run, recording.rig, *recording.returns, request, out, parallel);
  fs::remove_all(output);
  return run.summary;
}

}  // namespace lidarena::live
