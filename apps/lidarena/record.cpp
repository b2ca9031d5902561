// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <chrono>
#include <map>

#include "adapters/dds/live_reader.hpp"
#include "adapters/live/interrupt.hpp"
#include "adapters/live/record_run.hpp"
#include "apps/lidarena/console.hpp"
#include "apps/lidarena/live_topics.hpp"
#include "apps/lidarena/verbs.hpp"
#include "lidarena/base/error.hpp"
#include "lidarena/dataset/messages/ros_messages.hpp"
#include "lidarena/dataset/recording.hpp"
#include "lidarena/results/summary.hpp"

namespace lidarena {
namespace {

namespace fs = std::filesystem;

struct RecordRequest {
  std::string out;
  std::vector<std::string> topics;
  double idle_s = 2.0;
  bool compress = false;
  dds::LiveOptions live;
  live::RunToRecord run;  ///< instead of a file, if it names a dataset
};

/// Writes live messages into a file as they come, with the times at which they were sent.
class Recorder {
 public:
  Recorder(const fs::path& file, bool compress, LogSink& log)
      : out_(dataset::create_recording(file, {.format = dataset::RecordingFormat::kMcap,
                                              .compress = compress,
                                              .name = {},
                                              .description = {}})),
        log_(log) {}

  void add(const dataset::RecordedMessage& message) {
    const std::string name(message.topic);
    const Time now = std::chrono::system_clock::now().time_since_epoch();
    delays_[name].push_back(to_seconds(now - message.log_time));
    const auto [entry, is_new] = topics_.try_emplace(name);
    if (is_new) {
      if (dataset::ros::has_definition(message.type)) {
        entry->second = out_->add_topic(name, message.type, false);
        log_.info(fmt::format("{} [{}]", name, message.type));
      } else {
        log_.warn(
            fmt::format("{} is left out: messages of {} cannot be written", name, message.type));
      }
    }
    if (entry->second)
      out_->write(*entry->second, message.log_time, message.log_time, message.data);
  }

  /// {topic: {messages, lost, delay_median_s, delay_p99_s}}: of the time from sending to receipt.
  Json topics(const dds::LiveReader& live) {
    Json topics = Json::object();
    for (auto& [name, delays] : delays_) {
      topics[name] = {{"messages", delays.size()},
                      {"lost", live.lost(name)},
                      {"delay_median_s", results::quantile(delays, 0.5)},
                      {"delay_p99_s", results::quantile(delays, 0.99)}};
    }
    return topics;
  }

  dataset::RecordingInfo finish() {
    dataset::RecordingInfo info = out_->info();
    out_->close();
    return info;
  }

 private:
  std::unique_ptr<dataset::RecordingWriter> out_;
  LogSink& log_;
  std::map<std::string, std::optional<std::uint16_t>> topics_;
  std::map<std::string, std::vector<double>> delays_;  ///< s, of all messages of a topic
};

int record_results(const Common& common, const RecordRequest& request) {
  Console log(common.quiet);
  const std::size_t poses = live::record_run(request.run, request.live, request.idle_s, request.out,
                                             Parallel(common.threads), log);
  if (common.json) {
    print_json({{"poses", poses}, {"run", request.out}});
  } else {
    fmt::print("recorded {} poses; score them: lidarena evaluate {}\n", poses, request.out);
  }
  return kDone;
}

int record(const Common& common, const RecordRequest& request) {
  if (!request.run.dataset.empty()) return record_results(common, request);
  if (!(request.run.topics.odometry + request.run.topics.path + request.run.topics.points).empty())
    throw InputError("record", "names topics of results",
                     "say with --truth what they are scored "
                     "against, or give --topic");
  Console log(common.quiet || common.json);
  dds::LiveReaderOptions reading;
  reading.topics = {request.topics.begin(), request.topics.end()};
  reading.idle = std::chrono::milliseconds(static_cast<int>(1e3 * request.idle_s));
  reading.stopped = live::end_on_interrupt();
  dds::LiveReader live(request.live, reading);
  Recorder recorder(request.out, request.compress, log);
  while (const auto message = live.next()) recorder.add(*message);
  const dataset::RecordingInfo info = recorder.finish();
  if (common.json) {
    print_json({{"messages", info.message_count},
                {"lost", live.lost()},
                {"topics", recorder.topics(live)}});
  } else {
    fmt::print("recorded {} messages on {} topics, {} lost: {}\n", info.message_count,
               info.topics.size(), live.lost(), request.out);
  }
  return info.message_count > 0 ? kDone : kWorkFailed;
}

}  // namespace

void add_record(CLI::App& app, Common& common, int& exit_code) {
  auto* verb = app.add_subcommand(
      "record", "Write live topics of ROS 2 nodes into an MCAP file, or a SLAM node's into a RUN");
  auto request = std::make_shared<RecordRequest>();
  verb->add_option("--out", request->out, "MCAP file to write; with --truth: RUN folder")
      ->required();
  verb->add_option("--topic", request->topics, "Topics to record; default: all");
  verb->add_option("--idle", request->idle_s,
                   "Ends when nothing came for so many seconds after the first message; 0: only by "
                   "Ctrl-C")
      ->check(CLI::NonNegativeNumber);
  verb->add_flag("--compress", request->compress, "Compress the file (zstd)");
  add_run_to_record(*verb, request->run);
  add_live_options(*verb, request->live);
  set_verb(
      *verb, common, [&common, request] { return record(common, *request); }, exit_code);
}

}  // namespace lidarena
