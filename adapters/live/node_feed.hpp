// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "adapters/dds/live_reader.hpp"
#include "lidarena/base/config_json.hpp"

namespace lidarena::live {

/// Reads what a node publishes, in a thread of its own, until it is told to stop. Another
/// participant of this process that is created later must end earlier.
class Answers {
 public:
  using Keep = std::function<void(const dataset::RecordedMessage&)>;
  using Deadline = std::chrono::steady_clock::time_point;

  /// `topic`: the one on which the node answers scans, with messages of any type that begins with a
  /// header. `keep`, if given, gets the messages on it and on `also`, on the other thread.
  Answers(const dds::LiveOptions& live, const std::string& topic, std::set<std::string> also = {},
          Keep keep = {});
  ~Answers();

  /// Whether a publisher of the topic was found.
  bool has_publisher() const { return found_; }
  /// Waits for a message on the topic whose stamp is not earlier than `scan`, and returns when it
  /// was sent (since the Unix epoch); empty after the deadline, or when `stopped` is true. Earlier
  /// messages are forgotten. Throws what `keep` threw.
  std::optional<Time> wait_for(Time scan, Deadline deadline, const std::function<bool()>& stopped);
  /// Waits until nothing came for `idle`, at most for `limit`.
  void settle(std::chrono::milliseconds idle, std::chrono::milliseconds limit);
  /// Ends the thread. The rest may then be asked.
  void stop();

  std::uint64_t lost() const { return reader_.lost(); }
  std::uint64_t bad() const { return bad_; }  ///< messages on the topic without a whole header

 private:
  void read();
  void add(const dataset::RecordedMessage& message);

  std::string topic_;
  Keep keep_;
  std::atomic<bool> found_ = false, stopped_ = false;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<Time, Time> sent_;  ///< when the answers were sent, by their stamps
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
  std::uint64_t bad_ = 0;
  std::exception_ptr failure_;
  dds::LiveReader reader_;
  std::thread thread_;
};

/// How a node is fed.
struct FeedOptions {
  std::string answer;           ///< topic on which it answers
  bool lock_step = true;        ///< the next scan after the answer to this one; else at a rate
  double answer_limit_s = 5.0;  ///< an answer that takes longer is not waited for
  double start_limit_s = 60.0;  ///< the same of the node's appearance
};

/// Feeds a node: waits until it is there and, in lock-step, for the answer to each scan.
class NodeFeed {
 public:
  /// `stopped` ends all waiting when it is true or throws.
  NodeFeed(FeedOptions options, Answers& answers, std::function<bool()> stopped);

  /// Waits until the scans have a subscriber and the answers a publisher. Throws Error after the
  /// limit.
  void wait_for_node(const std::string& scan_topic, const std::function<bool()>& has_subscriber);
  /// In lock-step, waits for the answer to the scan that was sent last. Throws Error if scan after
  /// scan has no answer.
  void wait_for_answer();
  /// A scan, a message that begins with a header, is sent now.
  void sent(dataset::Bytes scan);

  /// {answered, unanswered, answer_median_s, answer_p99_s, answer_max_s}: times from sending a scan
  /// to sending the answer. Empty if not in lock-step.
  Json summary() const;
  std::size_t unanswered() const { return unanswered_; }

 private:
  FeedOptions options_;
  Answers& answers_;
  std::function<bool()> stopped_;
  struct Awaited {
    Time stamp{0};
    Time sent{0};  ///< since the Unix epoch
  };
  std::optional<Awaited> awaited_;
  std::vector<double> delays_s_;
  std::size_t unanswered_ = 0, in_a_row_ = 0;
};

}  // namespace lidarena::live
