// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
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
  /// By topic: messages that may wait to be read; a later one then takes the place of the oldest,
  /// which is lost. Topics without an entry: all.
  std::map<std::string, int> waiting{};
  /// Whether to read a topic of messages of a type (both as in ROS 2) that is in `topics`.
  std::function<bool(const std::string& topic, const std::string& type)> wanted{};
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
  /// Messages that were sent and not received, or received and replaced before they were read: by
  /// their publishers' numbers, from the first one on that was returned of each publisher. Those
  /// from this process have no numbers.
  std::uint64_t lost() const;
  std::uint64_t lost(const std::string& topic) const;
  /// The topics of ROS 2 nodes that were seen so far, read or not, with their types.
  const std::map<std::string, std::string>& seen() const { return seen_; }

 private:
  using Guid = std::array<std::uint8_t, 16>;  ///< of a publisher, also after it was out of reach
  struct Subscription {
    Entity topic, reader;
    std::map<std::uint64_t, Guid> publishers{};  ///< by the handle that Cyclone DDS gave
    std::map<Guid, std::int64_t> received{};     ///< number of the last message
    std::uint64_t lost = 0;
  };
  struct Message {
    std::size_t topic;
    Time sent;
    ddsi_serdata* data;
  };

  void find_topics();
  void subscribe(const dds_builtintopic_endpoint_t& publisher);
  bool wants(const std::string& topic, const std::string& type) const;
  void take(std::size_t topic);
  static void note_received(Subscription& from, std::uint64_t publisher, std::int64_t sequence);
  void release_current();

  LiveReaderOptions reading_;
  Participant participant_;
  Entity publications_, waiting_;
  std::map<std::string, std::string> seen_;
  std::vector<dataset::RecordedTopic> found_;
  std::vector<Subscription> subscriptions_;
  std::deque<Message> taken_;
  std::optional<Message> current_;
  bool started_ = false;
};

}  // namespace lidarena::dds
