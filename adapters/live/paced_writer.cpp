// SPDX-License-Identifier: BSD-3-Clause
#include "adapters/live/paced_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <thread>
#include <utility>

#include "lidarena/dataset/dataset_layout.hpp"
#include "lidarena/dataset/messages/ros_messages.hpp"

namespace lidarena::live {
namespace {

constexpr auto kClockPeriod = std::chrono::milliseconds(10);  // of /clock, recorded time
constexpr double kLate_s = 0.01;  // a message that is sent later than this is counted
constexpr auto kLongestSleep = std::chrono::milliseconds(50);
/// Messages of a topic that are kept for slow subscribers: as nodes have it, and, without a pause
/// between them, enough for all samples of the IMU between two scans.
constexpr int kKept = 5, kKeptWithoutPause = 1000;

bool is_truth(const std::string& topic) {
  return topic.starts_with(dataset::layout::kTruthPrefix) || topic == "/tf";
}

}  // namespace

PacedWriter::PacedWriter(const dds::LiveOptions& live, const Pace& pace,
                         std::function<bool()> stopped, NodeFeed* feed, std::string scan_topic)
    : pace_(pace),
      stopped_(std::move(stopped)),
      feed_(feed),
      scan_topic_(std::move(scan_topic)),
      out_(live, pace.rate > 0.0 ? kKept : kKeptWithoutPause),
      clock_(out_.add_topic("/clock", dataset::ros::kClock, false)) {}

std::uint16_t PacedWriter::add_topic(const std::string& name, std::string_view type, bool latched) {
  std::optional<std::uint16_t> topic;
  if (!pace_.sensors_only || !is_truth(name)) topic = out_.add_topic(name, type, latched);
  if (name == scan_topic_) scans_ = topic;
  topics_.push_back(topic);
  return static_cast<std::uint16_t>(topics_.size() - 1);
}

void PacedWriter::write(std::uint16_t topic, Time log_time, Time publish_time,
                        dataset::Bytes message) {
  const std::optional<std::uint16_t> to = topics_.at(topic);
  if (!to) return;
  if (!start_) begin(log_time);
  auto due = begin_;
  if (pace_.rate > 0.0) {
    due += std::chrono::duration_cast<Clock::duration>(
        std::chrono::duration<double>(to_seconds(log_time - *start_) / pace_.rate));
    wait_until(due);
  }
  const bool is_scan = feed_ != nullptr && to == scans_;
  if (is_scan) {
    const auto asked = Clock::now();
    feed_->wait_for_answer();
    begin_ += Clock::now() - asked;
    due += Clock::now() - asked;
  }
  if (stopped_()) return;
  if (pace_.rate > 0.0) note_delay(std::chrono::duration<double>(Clock::now() - due).count());
  publish_clock(log_time);
  if (is_scan) feed_->sent(message);
  out_.write(*to, log_time, publish_time, message);
}

void PacedWriter::close() {
  if (feed_ != nullptr) feed_->wait_for_answer();
  out_.close();
}

void PacedWriter::begin(Time first) {
  if (feed_ != nullptr && scans_)
    feed_->wait_for_node(scan_topic_, [&] { return out_.subscribers(*scans_) > 0; });
  wait_until(Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                std::chrono::duration<double>(pace_.wait_s)));
  start_ = first;
  begin_ = first_ = Clock::now();
}

void PacedWriter::wait_until(Clock::time_point due) const {
  for (auto now = Clock::now(); now < due && !stopped_(); now = Clock::now())
    std::this_thread::sleep_for(std::min<Clock::duration>(due - now, kLongestSleep));
}

void PacedWriter::note_delay(double delay_s) {
  longest_delay_s_ = std::max(longest_delay_s_, delay_s);
  if (delay_s > kLate_s) ++late_;
}

void PacedWriter::publish_clock(Time now) {
  if (last_clock_ && now < *last_clock_ + kClockPeriod) return;
  last_clock_ = now;
  dataset::ros::encode_clock(now, message_);
  out_.write(clock_, now, now, message_.bytes());
}

Json PacedWriter::summary() const {
  Json topics = Json::object();
  const dataset::RecordingInfo sent = out_.info();
  for (std::size_t i = 0; i < sent.topics.size(); ++i) {
    topics[sent.topics[i].topic] = {
        {"messages", sent.topics[i].message_count},
        {"subscribers", out_.subscribers(static_cast<std::uint16_t>(i))}};
  }
  const double seconds =
      start_ ? std::chrono::duration<double>(Clock::now() - first_).count() : 0.0;
  Json summary{{"seconds", seconds},
               {"messages", sent.message_count},
               {"late", late_},
               {"longest_delay_s", longest_delay_s_},
               {"topics", topics}};
  if (feed_ != nullptr) summary.update(feed_->summary());
  return summary;
}

std::string PacedWriter::summary_text() const {
  const Json told = summary();
  std::string text = fmt::format("{} messages", told["messages"].get<std::uint64_t>());
  if (pace_.rate > 0.0) {
    text += fmt::format("; {} were late by more than 10 ms, at most {:.0f} ms", late_,
                        1e3 * longest_delay_s_);
  }
  if (told.contains("answered")) {
    text += fmt::format("; {} scans were answered (median {:.1f} ms), {} were not",
                        told["answered"].get<std::size_t>(),
                        1e3 * told.value("answer_median_s", 0.0), feed_->unanswered());
  }
  return text;
}

}  // namespace lidarena::live
