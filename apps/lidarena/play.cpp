// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <memory>
#include <optional>

#include "adapters/live/interrupt.hpp"
#include "adapters/live/player.hpp"
#include "apps/lidarena/console.hpp"
#include "apps/lidarena/live_topics.hpp"
#include "apps/lidarena/verbs.hpp"
#include "lidarena/base/error.hpp"

namespace lidarena {
namespace {

struct PlayRequest {
  std::string input;
  std::optional<double> rate;
  double wait_s = 1.0;
  bool sensors_only = false;
  std::string points_topic;
  live::FeedOptions feed;  ///< lock-step if it names a topic of answers
  dds::LiveOptions live;
};

int report_played(const Common& common, const live::PacedWriter& out) {
  if (common.json) {
    print_json(out.summary());
  } else {
    fmt::print("played {}\n", out.summary_text());
  }
  return kDone;
}

int play(const Common& common, const PlayRequest& request) {
  Console log(common.quiet || common.json);
  const std::filesystem::path file = live::recording_in(request.input);
  const auto stopped = live::end_on_interrupt();
  const bool in_lock_step = !request.feed.answer.empty();
  const live::Pace pace{request.rate.value_or(in_lock_step ? 0.0 : 1.0), request.wait_s,
                        request.sensors_only};
  if (!in_lock_step) {
    live::PacedWriter out(request.live, pace, stopped);
    live::play_recording(file, out, stopped, log);
    out.close();
    return report_played(common, out);
  }
  const std::string scans = live::scan_topic_of(file, request.points_topic);
  live::Answers answers(request.live, request.feed.answer);
  live::NodeFeed feed(request.feed, answers, stopped);
  live::PacedWriter out(request.live, pace, stopped, &feed, scans);
  log.info("waits for a node that subscribes to " + scans + " and publishes " +
           request.feed.answer);
  live::play_recording(file, out, stopped, log);
  out.close();
  return report_played(common, out);
}

}  // namespace

void add_play(CLI::App& app, Common& common, int& exit_code) {
  auto* verb = app.add_subcommand(
      "play", "Publish a dataset or MCAP file on live topics that ROS 2 nodes understand");
  auto request = std::make_shared<PlayRequest>();
  verb->add_option("dataset", request->input, "DATASET folder or MCAP file")->required();
  verb->add_option(
          "--rate", request->rate,
          "Speed, times that of the recording; with --lock-step the fastest, default: none")
      ->check(CLI::PositiveNumber);
  verb->add_option("--wait", request->wait_s,
                   "Seconds before the first message, in which subscribers find the topics")
      ->check(CLI::NonNegativeNumber);
  verb->add_flag("--sensors-only", request->sensors_only,
                 "Leave out the truth: /truth/... and /tf");
  add_topic_option(*verb, "--lock-step", request->feed.answer,
                   "Publish each scan after a node's answer to the one before: a message on this "
                   "topic, e.g. /odom, whose stamp is not earlier than the scan's");
  verb->add_option("--answer-limit", request->feed.answer_limit_s,
                   "With --lock-step: seconds to wait for an answer")
      ->check(CLI::PositiveNumber);
  verb->add_option("--start-limit", request->feed.start_limit_s,
                   "With --lock-step: seconds to wait for the node's topics")
      ->check(CLI::PositiveNumber);
  add_topic_option(*verb, "--points-topic", request->points_topic,
                   "With --lock-step: the scans that are answered; default: the only LiDAR's");
  add_live_options(*verb, request->live);
  set_verb(
      *verb, common, [&common, request] { return play(common, *request); }, exit_code);
}

}  // namespace lidarena
