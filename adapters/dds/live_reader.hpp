// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "adapters/dds/participant.hpp"
#include "lidarena/dataset/recording.hpp"

struct ddsi_serdata;
struct ddsi_sertype;

namespace lidarena::dds {

struct LiveReaderOptions {
  std::set<std::string> topics;  ///< names as in ROS 2; empty: all
  /// Ends when nothing came for this long after the first message; 0: only `stopped` ends it.
  std::chrono::milliseconds idle{2000};
  /// Asked at least ten times a second; true ends the reading.
  std::function<bool()> stopped = [] { return false; };
};

/// Subscribes to the topics of ROS 2 nodes as they appear, with the reliability and durability that
/// each publisher offers, and returns their messages in the order in which they came. log_time is
/// the time at which the publisher sent a message (since the Unix epoch).
class LiveReader final : public dataset::RecordingReader {
 public:
  LiveReader(const LiveOptions& options, LiveReaderOptions reading);
  ~LiveReader() override;

  /// Waits for the next message. Empty at the end.
  std::optional<dataset::RecordedMessage> next() override;

  /// Topics found so far and how many messages of each were returned.
  const std::vector<dataset::RecordedTopic>& topics() const { return found_; }
  /// Messages that were lost, as far as the subscriptions know.
  std::uint64_t lost() const;

 private:
  struct Subscription {
    Entity topic, reader;
  };
  struct Message {
    std::size_t topic;
    Time sent;
    ddsi_serdata* data;
  };

  void find_topics();
  void subscribe(const dds_builtintopic_endpoint_t& publisher);
  void take(std::size_t topic);
  void release_current();

  LiveReaderOptions reading_;
  Participant participant_;
  Entity publications_, waiting_;
  std::vector<dataset::RecordedTopic> found_;
  std::vector<Subscription> subscriptions_;
  std::deque<Message> taken_;
  std::optional<Message> current_;
  bool started_ = false;
};

}  // namespace lidarena::dds
