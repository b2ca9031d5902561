// SPDX-License-Identifier: BSD-3-Clause
#include "adapters/dds/live_reader.hpp"

#include <dds/ddsi/ddsi_serdata.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>

#include "adapters/dds/cdr_type.hpp"
#include "lidarena/base/error.hpp"

namespace lidarena::dds {
namespace {

constexpr dds_duration_t kWait = DDS_MSECS(20);  // until new topics are looked for
constexpr std::size_t kTaken = 64;               // messages taken from a topic at once

struct DeleteReaderQos {
  void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
};
using ReaderQos = std::unique_ptr<dds_qos_t, DeleteReaderQos>;

/// The reliability and durability that a publisher offers; `waiting`: as LiveReaderOptions has it.
ReaderQos reader_qos(const dds_qos_t* offered, std::optional<int> waiting) {
  ReaderQos qos(dds_create_qos());
  dds_reliability_kind_t reliability = DDS_RELIABILITY_BEST_EFFORT;
  dds_durability_kind_t durability = DDS_DURABILITY_VOLATILE;
  dds_duration_t blocking = 0;
  dds_qget_reliability(offered, &reliability, &blocking);
  dds_qget_durability(offered, &durability);
  dds_qset_reliability(qos.get(), reliability, blocking);
  dds_qset_durability(qos.get(), durability);
  dds_qset_history(qos.get(), waiting ? DDS_HISTORY_KEEP_LAST : DDS_HISTORY_KEEP_ALL,
                   waiting.value_or(0));
  return qos;
}

}  // namespace

LiveReader::LiveReader(const LiveOptions& options, LiveReaderOptions reading)
    : reading_(std::move(reading)),
      participant_(options),
      publications_(dds_create_reader(participant_.get(), DDS_BUILTIN_TOPIC_DCPSPUBLICATION,
                                      nullptr, nullptr),
                    "live topics"),
      waiting_(dds_create_waitset(participant_.get()), "live topics") {}

LiveReader::~LiveReader() {
  release_current();
  for (const Message& message : taken_) ddsi_serdata_unref(message.data);
}

void LiveReader::release_current() {
  if (current_) ddsi_serdata_unref(current_->data);
  current_.reset();
}

std::optional<dataset::RecordedMessage> LiveReader::next() {
  release_current();
  const auto idle_since = std::chrono::steady_clock::now();
  while (taken_.empty()) {
    if (reading_.stopped()) return std::nullopt;
    find_topics();
    dds_waitset_wait(waiting_.get(), nullptr, 0, kWait);
    for (std::size_t i = 0; i < subscriptions_.size(); ++i) take(i);
    const auto idle = std::chrono::steady_clock::now() - idle_since;
    if (started_ && reading_.idle.count() > 0 && idle > reading_.idle) return std::nullopt;
  }
  started_ = true;
  current_ = taken_.front();
  taken_.pop_front();
  dataset::RecordedTopic& topic = found_[current_->topic];
  ++topic.message_count;
  return dataset::RecordedMessage{topic.topic, topic.type, dataset::Encoding::kCdr, current_->sent,
                                  message_of(current_->data)};
}

void LiveReader::find_topics() {
  void* sample = nullptr;
  dds_sample_info_t info;
  while (dds_take(publications_.get(), &sample, &info, 1, 1) > 0) {
    if (info.valid_data) subscribe(*static_cast<const dds_builtintopic_endpoint_t*>(sample));
    dds_return_loan(publications_.get(), &sample, 1);
  }
}

void LiveReader::subscribe(const dds_builtintopic_endpoint_t& publisher) {
  const std::string name = ros_topic_of(publisher.topic_name);
  const std::string type = ros_type_of(publisher.type_name);
  if (name.empty() || type.empty()) return;  // not of a ROS 2 node
  seen_[name] = type;
  if (!wants(name, type)) return;
  if (std::ranges::find(found_, name, &dataset::RecordedTopic::topic) != found_.end()) return;
  const CdrTopic created =
      create_cdr_topic(participant_.get(), publisher.topic_name, publisher.type_name);
  Subscription subscription{Entity(created.topic, name), {}};
  const auto waiting = reading_.waiting.find(name);
  const ReaderQos qos =
      reader_qos(publisher.qos,
                 waiting == reading_.waiting.end() ? std::nullopt : std::optional(waiting->second));
  subscription.reader =
      Entity(dds_create_reader(participant_.get(), created.topic, qos.get(), nullptr), name);
  dds_set_status_mask(subscription.reader.get(), DDS_DATA_AVAILABLE_STATUS);
  dds_waitset_attach(waiting_.get(), subscription.reader.get(), 0);
  found_.push_back({name, type, "cdr", 0});
  subscriptions_.push_back(std::move(subscription));
}

bool LiveReader::wants(const std::string& topic, const std::string& type) const {
  if (!reading_.topics.empty() && !reading_.topics.contains(topic)) return false;
  return !reading_.wanted || reading_.wanted(topic, type);
}

void LiveReader::take(std::size_t topic) {
  std::array<ddsi_serdata*, kTaken> data{};
  std::array<dds_sample_info_t, kTaken> info;
  const dds_entity_t reader = subscriptions_[topic].reader.get();
  const int count = dds_takecdr(reader, data.data(), kTaken, info.data(), DDS_ANY_STATE);
  for (int i = 0; i < count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (info[k].valid_data) {
      note_received(subscriptions_[topic], info[k].publication_handle, sequence_of(data[k]));
      taken_.push_back({topic, Time{info[k].source_timestamp}, data[k]});
    } else {
      ddsi_serdata_unref(data[k]);
    }
  }
}

void LiveReader::note_received(Subscription& from, std::uint64_t publisher, std::int64_t sequence) {
  if (sequence == 0) return;
  const auto [guid, is_new] = from.publishers.try_emplace(publisher);
  if (is_new) {
    // A publisher that was out of reach for a while returns with the same GUID and another handle.
    if (auto* found = dds_get_matched_publication_data(from.reader.get(), publisher)) {
      std::ranges::copy(found->key.v, guid->second.begin());
      dds_builtintopic_free_endpoint(found);
    } else {
      std::memcpy(guid->second.data(), &publisher, sizeof publisher);
    }
  }
  std::int64_t& last = from.received[guid->second];
  if (last > 0 && sequence > last + 1) from.lost += static_cast<std::uint64_t>(sequence - last - 1);
  last = std::max(last, sequence);
}

std::uint64_t LiveReader::lost() const {
  std::uint64_t lost = 0;
  for (const Subscription& subscription : subscriptions_) lost += subscription.lost;
  return lost;
}

std::uint64_t LiveReader::lost(const std::string& topic) const {
  const auto found = std::ranges::find(found_, topic, &dataset::RecordedTopic::topic);
  return found == found_.end()
             ? 0
             : subscriptions_[static_cast<std::size_t>(found - found_.begin())].lost;
}

}  // namespace lidarena::dds
