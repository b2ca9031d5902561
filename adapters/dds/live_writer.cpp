// SPDX-License-Identifier: BSD-3-Clause
#include "adapters/dds/live_writer.hpp"

#include <dds/ddsi/ddsi_serdata.h>

#include <algorithm>
#include <memory>

#include "adapters/dds/cdr_type.hpp"
#include "lidarena/base/error.hpp"

namespace lidarena::dds {
namespace {

constexpr dds_duration_t kMaxBlocking = 0;  // a limited history never blocks
constexpr dds_duration_t kLastDelivery = DDS_SECS(3);

struct DeleteQos {
  void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
};

std::unique_ptr<dds_qos_t, DeleteQos> writer_qos(bool latched, int kept) {
  std::unique_ptr<dds_qos_t, DeleteQos> qos(dds_create_qos());
  dds_qset_reliability(qos.get(), DDS_RELIABILITY_RELIABLE, kMaxBlocking);
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, latched ? 1 : kept);
  dds_qset_durability(qos.get(),
                      latched ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  return qos;
}

}  // namespace

LiveWriter::LiveWriter(const LiveOptions& options, int kept) : participant_(options), kept_(kept) {}

std::uint16_t LiveWriter::add_topic(const std::string& name, std::string_view type, bool latched) {
  const CdrTopic created =
      create_cdr_topic(participant_.get(), dds_topic_of(name), dds_type_of(type));
  Topic topic{Entity(created.topic, name), {}, created.type};
  const auto qos = writer_qos(latched, kept_);
  topic.writer =
      Entity(dds_create_writer(participant_.get(), created.topic, qos.get(), nullptr), name);
  topics_.push_back(std::move(topic));
  info_.topics.push_back({name, std::string(type), "cdr", 0});
  return static_cast<std::uint16_t>(topics_.size() - 1);
}

void LiveWriter::write(std::uint16_t topic, Time log_time, Time, dataset::Bytes message) {
  const Topic& at = topics_.at(topic);
  const dds_return_t sent = dds_writecdr(at.writer.get(), make_data(at.type, message));
  if (sent < 0) throw Error(info_.topics[topic].topic + ": " + dds_strretcode(sent));
  info_.start = info_.message_count == 0 ? log_time : std::min(info_.start, log_time);
  info_.end = std::max(info_.end, log_time);
  ++info_.message_count;
  ++info_.topics[topic].message_count;
}

void LiveWriter::close() {
  for (const Topic& topic : topics_) dds_wait_for_acks(topic.writer.get(), kLastDelivery);
}

std::size_t LiveWriter::subscribers(std::uint16_t topic) const {
  dds_publication_matched_status_t status{};
  dds_get_publication_matched_status(topics_.at(topic).writer.get(), &status);
  return status.current_count;
}

}  // namespace lidarena::dds
