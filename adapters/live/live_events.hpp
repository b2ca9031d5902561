// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "adapters/dds/live_reader.hpp"
#include "lidarena/base/config_json.hpp"
#include "lidarena/base/log.hpp"
#include "lidarena/dataset/recording_source.hpp"
#include "lidarena/dataset/stream_merge.hpp"

namespace lidarena::live {

/// Measurements that arrive on live topics, in the order that EventSource guarantees. A message
/// that cannot be read, or whose stamp goes back (of a scan: does not advance), is left out and
/// counted; the first one of a topic is a warning. The measurements end early where the IMU fails.
class LiveEvents final : public EventSource {
 public:
  /// `imus`: ids of the IMUs that a scan waits for.
  LiveEvents(const dds::LiveOptions& live, dds::LiveReaderOptions reading,
             dataset::RecordedSensors sensors, const std::vector<std::string>& imus, LogSink& log);

  std::optional<Event> next() override;

  /// {lost, bad, out_of_order, ended}: by topic how many messages were lost on the way, could not
  /// be read, or were not later than the one before; why the measurements ended early. Without what
  /// there is none of.
  Json summary() const;
  std::uint64_t lost() const { return reader_.lost(); }

 private:
  struct Faults {
    std::uint64_t bad = 0, out_of_order = 0;
    std::optional<Time> last;  ///< stamp of the last good one
  };

  void read_next();
  void deliver(const dataset::RecordedMessage& message);
  std::optional<Event> decoded(const dataset::RecordedMessage& message, const std::string& topic);
  bool is_later(const Event& event, const std::string& topic);

  dataset::RecordedSensors sensors_;
  LogSink& log_;
  dds::LiveReader reader_;
  dataset::StreamMerge merge_;
  std::map<std::string, Faults> faults_;  ///< by topic
  std::string ended_;
  bool finished_ = false;
};

}  // namespace lidarena::live
