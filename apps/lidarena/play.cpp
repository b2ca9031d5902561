// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <thread>

#include "adapters/dds/live_writer.hpp"
#include "apps/lidarena/console.hpp"
#include "apps/lidarena/live.hpp"
#include "apps/lidarena/verbs.hpp"
#include "lidarena/base/error.hpp"
#include "lidarena/dataset/dataset_layout.hpp"
#include "lidarena/dataset/messages/ros_messages.hpp"
#include "lidarena/dataset/recording.hpp"

namespace lidarena {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr auto kClockPeriod = std::chrono::milliseconds(10);  // of /clock, recorded time
constexpr double kLate_s = 0.01;  // a message that is sent later than this is counted

struct PlayRequest {
  std::string input;
  double rate = 1.0;
  double wait_s = 1.0;
  dds::LiveOptions live;
};

fs::path recording_in(const fs::path& input) {
  if (!fs::is_directory(input)) return input;
  if (fs::exists(input / dataset::layout::kData)) return input / dataset::layout::kData;
  throw InputError(input.string(), "has no data.mcap",
                   "lidarena convert " + input.string() + " OUT");
}

/// The topics of a recording, published by their names, and /clock.
class Player {
 public:
  Player(const fs::path& file, const PlayRequest& request)
      : info_(dataset::read_recording_info(file)),
        reader_(dataset::open_recording(file)),
        request_(request),
        out_(request.live) {
    for (const dataset::RecordedTopic& topic : info_.topics) {
      if (topic.message_encoding != "cdr") {
        throw InputError(file.string(), "has messages of another kind than ROS 2's",
                         "lidarena convert " + file.string() + " OUT.mcap");
      }
      topics_[topic.topic] = out_.add_topic(topic.topic, topic.type, topic.topic == "/tf_static");
    }
    clock_ = out_.add_topic("/clock", dataset::ros::kClock, false);
  }

  /// Publishes all messages at the recorded rate times the asked one.
  Json play(LogSink& log) {
    std::this_thread::sleep_for(std::chrono::duration<double>(request_.wait_s));
    const auto stopped = end_on_interrupt();
    const Clock::time_point begin = Clock::now();
    while (const auto message = reader_->next()) {
      const double at_s = to_seconds(message->log_time - info_.start);
      const auto due = begin + std::chrono::duration_cast<Clock::duration>(
                                   std::chrono::duration<double>(at_s / request_.rate));
      std::this_thread::sleep_until(due);
      if (stopped()) break;
      note_delay(std::chrono::duration<double>(Clock::now() - due).count());
      publish_clock(message->log_time);
      out_.write(topics_.at(std::string(message->topic)), message->log_time, message->log_time,
                 message->data);
      log.progress("play", at_s, to_seconds(info_.end - info_.start));
    }
    out_.close();
    return summary(std::chrono::duration<double>(Clock::now() - begin).count());
  }

 private:
  void note_delay(double delay_s) {
    longest_delay_s_ = std::max(longest_delay_s_, delay_s);
    if (delay_s > kLate_s) ++late_;
  }

  void publish_clock(Time now) {
    if (last_clock_ && now < *last_clock_ + kClockPeriod) return;
    last_clock_ = now;
    dataset::ros::encode_clock(now, message_);
    out_.write(clock_, now, now, message_.bytes());
  }

  Json summary(double seconds) const {
    Json topics = Json::object();
    const dataset::RecordingInfo sent = out_.info();
    for (std::size_t i = 0; i < sent.topics.size(); ++i) {
      topics[sent.topics[i].topic] = {
          {"messages", sent.topics[i].message_count},
          {"subscribers", out_.subscribers(static_cast<std::uint16_t>(i))}};
    }
    return {{"seconds", seconds},
            {"messages", sent.message_count},
            {"late", late_},
            {"longest_delay_s", longest_delay_s_},
            {"topics", topics}};
  }

  dataset::RecordingInfo info_;
  std::unique_ptr<dataset::RecordingReader> reader_;
  const PlayRequest& request_;
  dds::LiveWriter out_;
  std::map<std::string, std::uint16_t> topics_;
  std::uint16_t clock_ = 0;
  std::optional<Time> last_clock_;
  dataset::MessageWriter message_;
  double longest_delay_s_ = 0.0;
  std::uint64_t late_ = 0;
};

int play(const Common& common, const PlayRequest& request) {
  Console log(common.quiet || common.json);
  Player player(recording_in(request.input), request);
  const Json played = player.play(log);
  if (common.json) {
    print_json(played);
  } else {
    fmt::print(
        "played {} messages in {:.1f} s; {} were late by more than 10 ms, at most {:.0f} ms\n",
        played["messages"].get<std::uint64_t>(), played["seconds"].get<double>(),
        played["late"].get<std::uint64_t>(), 1e3 * played["longest_delay_s"].get<double>());
  }
  return kDone;
}

}  // namespace

void add_play(CLI::App& app, Common& common, int& exit_code) {
  auto* verb = app.add_subcommand(
      "play", "Publish a dataset or MCAP file on live topics that ROS 2 nodes understand");
  auto request = std::make_shared<PlayRequest>();
  verb->add_option("dataset", request->input, "DATASET folder or MCAP file")->required();
  verb->add_option("--rate", request->rate, "Speed, times that of the recording")
      ->check(CLI::PositiveNumber);
  verb->add_option("--wait", request->wait_s,
                   "Seconds before the first message, in which subscribers find the topics")
      ->check(CLI::NonNegativeNumber);
  add_live_options(*verb, request->live);
  set_verb(
      *verb, common, [&common, request] { return play(common, *request); }, exit_code);
}

}  // namespace lidarena
