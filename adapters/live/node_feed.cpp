// SPDX-License-Identifier: BSD-3-Clause
#include "adapters/live/node_feed.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "lidarena/base/error.hpp"
#include "lidarena/dataset/messages/ros_messages.hpp"
#include "lidarena/results/summary.hpp"

namespace lidarena::live {
namespace {

constexpr auto kLook = std::chrono::milliseconds(20);  // how often it is asked whether to stop
/// Nodes that initialize leave out some scans; one that leaves out more does not answer at all.
constexpr std::size_t kMaxUnanswered = 20;

std::set<std::string> with(std::set<std::string> topics, const std::string& topic) {
  topics.insert(topic);
  return topics;
}

std::chrono::steady_clock::time_point in_seconds(double seconds) {
  return std::chrono::steady_clock::now() +
         std::chrono::duration_cast<std::chrono::steady_clock::duration>(
             std::chrono::duration<double>(seconds));
}

Time stamp_of(dataset::Bytes message, const std::string& place) {
  dataset::MessageReader in(message, place);
  return dataset::ros::get_header(in).stamp;
}

}  // namespace

Answers::Answers(const dds::LiveOptions& live, const std::string& topic, std::set<std::string> also,
                 Keep keep)
    : topic_(topic),
      keep_(std::move(keep)),
      reader_(live, {.topics = with(std::move(also), topic),
                     .idle = std::chrono::milliseconds(0),
                     .stopped =
                         [this] {
                           for (const dataset::RecordedTopic& found : reader_.topics())
                             if (found.topic == topic_) found_ = true;
                           return stopped_.load();
                         }}),
      thread_([this] { read(); }) {}

Answers::~Answers() { stop(); }

void Answers::stop() {
  stopped_ = true;
  if (thread_.joinable()) thread_.join();
}

void Answers::read() {
  try {
    while (const auto message = reader_.next()) add(*message);
  } catch (...) {
    const std::lock_guard lock(mutex_);
    failure_ = std::current_exception();
  }
  changed_.notify_all();
}

void Answers::add(const dataset::RecordedMessage& message) {
  if (keep_) keep_(message);
  const std::lock_guard lock(mutex_);
  last_ = std::chrono::steady_clock::now();
  if (message.topic != topic_) return;
  try {
    sent_.try_emplace(stamp_of(message.data, topic_), message.log_time);
  } catch (const InputError&) {
    ++bad_;
  }
  changed_.notify_all();
}

std::optional<Time> Answers::wait_for(Time scan, Deadline deadline,
                                      const std::function<bool()>& stopped) {
  std::unique_lock lock(mutex_);
  for (;;) {
    if (failure_) std::rethrow_exception(failure_);
    sent_.erase(sent_.begin(), sent_.lower_bound(scan));
    if (!sent_.empty()) return sent_.begin()->second;
    lock.unlock();
    if (stopped() || std::chrono::steady_clock::now() > deadline) return std::nullopt;
    lock.lock();
    changed_.wait_for(lock, kLook, [&] { return !sent_.empty() || failure_; });
  }
}

void Answers::settle(std::chrono::milliseconds idle, std::chrono::milliseconds limit) {
  const auto now = [] { return std::chrono::steady_clock::now(); };
  const auto begin = now();
  const auto last = [&] {
    const std::lock_guard lock(mutex_);
    return std::max(last_, begin);
  };
  while (now() < last() + idle && now() < begin + limit) std::this_thread::sleep_for(kLook);
}

NodeFeed::NodeFeed(FeedOptions options, Answers& answers, std::function<bool()> stopped)
    : options_(std::move(options)), answers_(answers), stopped_(std::move(stopped)) {}

void NodeFeed::wait_for_node(const std::string& scan_topic,
                             const std::function<bool()>& has_subscriber) {
  const auto deadline = in_seconds(options_.start_limit_s);
  while (!has_subscriber() || !answers_.has_publisher()) {
    if (stopped_()) return;
    if (std::chrono::steady_clock::now() > deadline) {
      throw Error(fmt::format(
          "{} within {:g} s; is the node running, with this ROS_DOMAIN_ID and these topics?",
          has_subscriber() ? "nobody publishes " + options_.answer
                           : "nobody subscribes to " + scan_topic,
          options_.start_limit_s));
    }
    std::this_thread::sleep_for(kLook);
  }
}

void NodeFeed::wait_for_answer() {
  if (!options_.lock_step || !awaited_) return;
  const Awaited scan = *std::exchange(awaited_, std::nullopt);
  const auto answer = answers_.wait_for(scan.stamp, in_seconds(options_.answer_limit_s), stopped_);
  if (answer) {
    delays_s_.push_back(to_seconds(*answer - scan.sent));
    in_a_row_ = 0;
    return;
  }
  if (stopped_()) return;
  ++unanswered_;
  if (++in_a_row_ < kMaxUnanswered) return;
  throw Error(
      fmt::format("{} scans in a row have no answer on {} within {:g} s each; a stamp "
                  "earlier than the scan's is none",
                  in_a_row_, options_.answer, options_.answer_limit_s));
}

void NodeFeed::sent(dataset::Bytes scan) {
  awaited_ = Awaited{stamp_of(scan, "a scan"), std::chrono::system_clock::now().time_since_epoch()};
}

Json NodeFeed::summary() const {
  if (!options_.lock_step) return Json::object();
  Json summary{{"answered", delays_s_.size()}, {"unanswered", unanswered_}};
  if (delays_s_.empty()) return summary;
  std::vector<double> delays = delays_s_;
  summary["answer_median_s"] = results::quantile(delays, 0.5);
  summary["answer_p99_s"] = results::quantile(delays, 0.99);
  summary["answer_max_s"] = results::quantile(delays, 1.0);
  return summary;
}

}  // namespace lidarena::live
