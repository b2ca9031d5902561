// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "adapters/dds/live_writer.hpp"
#include "adapters/live/node_feed.hpp"
#include "lidarena/base/config_json.hpp"

namespace lidarena::live {

/// When messages are published, and which.
struct Pace {
  double rate = 1.0;          ///< speed, times that of their own times; 0: without a pause
  double wait_s = 1.0;        ///< before the first, in which subscribers find the topics
  bool sensors_only = false;  ///< without the truth: /truth/..., /tf
};

/// Publishes messages at their times, and /clock.
class PacedWriter final : public dataset::RecordingWriter {
 public:
  /// `stopped`: asked while it waits; what is written after it was true is not published. `feed`,
  /// if given, decides when the messages on `scan_topic` are sent; it must outlive this object.
  PacedWriter(const dds::LiveOptions& live, const Pace& pace, std::function<bool()> stopped,
              NodeFeed* feed = nullptr, std::string scan_topic = {});

  dataset::Encoding encoding() const override { return out_.encoding(); }
  std::uint16_t add_topic(const std::string& name, std::string_view type, bool latched) override;
  void write(std::uint16_t topic, Time log_time, Time publish_time,
             dataset::Bytes message) override;
  dataset::RecordingInfo info() const override { return out_.info(); }
  /// Waits for the answer to the last scan, and until all subscribers have what was written.
  void close() override;

  /// {seconds, messages, late, longest_delay_s, topics: {NAME: {messages, subscribers}}}
  /// and, in lock-step, what NodeFeed::summary() tells.
  Json summary() const;
  /// The same in a sentence or two.
  std::string summary_text() const;

 private:
  using Clock = std::chrono::steady_clock;

  void begin(Time first);
  void wait_until(Clock::time_point due) const;
  void note_delay(double delay_s);
  void publish_clock(Time now);

  Pace pace_;
  std::function<bool()> stopped_;
  NodeFeed* feed_;
  std::string scan_topic_;
  dds::LiveWriter out_;
  std::vector<std::optional<std::uint16_t>> topics_;  ///< those of `out_`; empty: left out
  std::optional<std::uint16_t> scans_;                ///< of `out_`
  std::uint16_t clock_ = 0;
  std::optional<Time> start_, last_clock_;
  Clock::time_point begin_;  ///< when `start_` is due, without the time that answers took
  Clock::time_point first_;  ///< when the first message was sent
  dataset::MessageWriter message_;
  double longest_delay_s_ = 0.0;
  std::uint64_t late_ = 0;
};

}  // namespace lidarena::live
