// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>
#include <vector>

#include "adapters/dds/participant.hpp"
#include "lidarena/dataset/recording.hpp"

struct ddsi_sertype;

namespace lidarena::dds {

/// Publishes messages on topics that ROS 2 nodes understand: reliable, the last ones of a topic kept
/// for slow subscribers, which miss those before; of a latched topic the last one also reaches those
/// that come later. What is written is sent at once, and no subscriber delays it; times are not
/// sent, a message's own stamp is in its header.
class LiveWriter final : public dataset::RecordingWriter {
 public:
  /// `kept`: messages of a topic. Five, as ROS 2 nodes have it, is enough for what comes at a
  /// sensor's rate.
  explicit LiveWriter(const LiveOptions& options, int kept = 5);

  dataset::Encoding encoding() const override { return dataset::Encoding::kCdr; }
  std::uint16_t add_topic(const std::string& name, std::string_view type, bool latched) override;
  void write(std::uint16_t topic, Time log_time, Time publish_time,
             dataset::Bytes message) override;
  dataset::RecordingInfo info() const override { return info_; }
  /// Waits until all subscribers have what was written, at most some seconds.
  void close() override;

  /// Subscribers of a topic that were found so far.
  std::size_t subscribers(std::uint16_t topic) const;

 private:
  struct Topic {
    Entity topic, writer;
    const ddsi_sertype* type = nullptr;
  };

  Participant participant_;
  int kept_;
  std::vector<Topic> topics_;
  dataset::RecordingInfo info_;
};

}  // namespace lidarena::dds
