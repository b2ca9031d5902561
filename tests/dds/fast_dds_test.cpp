// SPDX-License-Identifier: BSD-3-Clause
// Live topics beside eProsima Fast DDS, on which ROS 2 runs by default.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#if LIDARENA_HAVE_FAST_DDS

#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>

#include <cstring>
#include <memory>

#include "tests/dds/live_helpers.hpp"

namespace lidarena::dds {
namespace {

namespace fast = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;

constexpr auto kOk = eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK;
constexpr std::size_t kMaxBytes = 4'000'000;

/// Messages that are serialized already; the data are a std::string.
class CdrMessage final : public fast::TopicDataType {
 public:
  explicit CdrMessage(const std::string& name) {
    setName(name.c_str());
    m_typeSize = kMaxBytes;
    m_isGetKeyDefined = false;
    auto_fill_type_object(false);
    auto_fill_type_information(false);
  }
  bool serialize(void* data, rtps::SerializedPayload_t* payload) override {
    const auto& bytes = *static_cast<const std::string*>(data);
    if (bytes.size() > payload->max_size) return false;
    std::memcpy(payload->data, bytes.data(), bytes.size());
    payload->length = static_cast<std::uint32_t>(bytes.size());
    payload->encapsulation = CDR_LE;
    return true;
  }
  bool deserialize(rtps::SerializedPayload_t* payload, void* data) override {
    static_cast<std::string*>(data)->assign(reinterpret_cast<const char*>(payload->data),
                                            payload->length);
    return true;
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
    return [data] { return static_cast<std::uint32_t>(static_cast<std::string*>(data)->size()); };
  }
  void* createData() override { return new std::string; }
  void deleteData(void* data) override { delete static_cast<std::string*>(data); }
  bool getKey(void*, rtps::InstanceHandle_t*, bool) override { return false; }
};

/// A participant on the loopback interface.
class FastParticipant {
 public:
  explicit FastParticipant(int domain) {
    fast::DomainParticipantQos qos;
    const auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
    udp->interfaceWhiteList.emplace_back("127.0.0.1");
    qos.transport().use_builtin_transports = false;
    qos.transport().user_transports.push_back(udp);
    rtps::Locator_t peer;
    rtps::IPLocator::setIPv4(peer, 127, 0, 0, 1);
    qos.wire_protocol().builtin.initialPeersList.push_back(peer);
    participant_ = fast::DomainParticipantFactory::get_instance()->create_participant(
        static_cast<fast::DomainId_t>(domain), qos);
  }
  ~FastParticipant() {
    participant_->delete_contained_entities();
    fast::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }
  FastParticipant(const FastParticipant&) = delete;
  FastParticipant& operator=(const FastParticipant&) = delete;

  fast::DataWriter* writer(const std::string& topic, std::string_view type) {
    fast::DataWriterQos qos;
    qos.history().kind = fast::KEEP_ALL_HISTORY_QOS;
    qos.endpoint().history_memory_policy = rtps::DYNAMIC_RESERVE_MEMORY_MODE;
    qos.publish_mode().kind = fast::ASYNCHRONOUS_PUBLISH_MODE;
    return participant_->create_publisher(fast::PUBLISHER_QOS_DEFAULT)
        ->create_datawriter(created(topic, type), qos);
  }
  fast::DataReader* reader(const std::string& topic, std::string_view type) {
    fast::DataReaderQos qos;
    qos.history().kind = fast::KEEP_ALL_HISTORY_QOS;
    qos.reliability().kind = fast::RELIABLE_RELIABILITY_QOS;
    qos.endpoint().history_memory_policy = rtps::DYNAMIC_RESERVE_MEMORY_MODE;
    return participant_->create_subscriber(fast::SUBSCRIBER_QOS_DEFAULT)
        ->create_datareader(created(topic, type), qos);
  }

 private:
  fast::Topic* created(const std::string& topic, std::string_view type) {
    const std::string name = dds_type_of(type);
    fast::TypeSupport(new CdrMessage(name)).register_type(participant_);
    return participant_->create_topic(dds_topic_of(topic), name, fast::TOPIC_QOS_DEFAULT);
  }

  fast::DomainParticipant* participant_ = nullptr;
};

/// Waits until `count` of a status is at least one.
template <class Count>
void wait_until_matched(const Count& count) {
  const auto end = std::chrono::steady_clock::now() + kLimit;
  while (count() < 1 && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  ASSERT_GE(count(), 1);
}

/// Without the padding to a multiple of four that DDS adds, which the header may state.
std::string without_padding(std::string message, std::size_t size) {
  EXPECT_LE(message.size() - size, 3U);
  message.resize(size);
  message[3] = '\0';
  return message;
}

TEST(FastDds, ReceivesWhatIsPublished) {
  const LiveOptions options = live_options();
  const std::vector<std::string> sent = by_topic(samples()).at(kPoints);
  FastParticipant fast_dds(options.domain);
  fast::DataReader* reader = fast_dds.reader(kPoints, dataset::ros::kPointCloud2);
  LiveWriter writer(options);
  const auto topic = writer.add_topic(kPoints, dataset::ros::kPointCloud2, false);
  wait_for_subscribers(writer, topic);
  wait_until_matched([&] {
    fast::SubscriptionMatchedStatus status;
    reader->get_subscription_matched_status(status);
    return status.current_count;
  });
  std::vector<std::string> received;
  for (const std::string& message : sent) {
    writer.write(topic, Time{1}, Time{1}, std::as_bytes(std::span(message)));
    std::string bytes;
    fast::SampleInfo info;
    if (!reader->wait_for_unread_message({5, 0})) break;
    if (reader->take_next_sample(&bytes, &info) != kOk) break;
    received.push_back(without_padding(bytes, message.size()));
  }
  EXPECT_EQ(received, sent);
}

TEST(FastDds, IsReceived) {
  const LiveOptions options = live_options();
  const std::vector<std::string> sent = by_topic(samples()).at(kImu);
  FastParticipant fast_dds(options.domain);
  fast::DataWriter* writer = fast_dds.writer(kImu, dataset::ros::kImu);
  LiveReader reader(options,
                    {.topics = {}, .idle = std::chrono::seconds(2), .stopped = after(kLimit)});
  std::thread publisher([&] {
    wait_until_matched([&] {
      fast::PublicationMatchedStatus status;
      writer->get_publication_matched_status(status);
      return status.current_count;
    });
    for (std::string message : sent) {
      writer->write(&message);
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  });
  const Messages received = read_all(reader);
  publisher.join();
  ASSERT_EQ(received.count(kImu), 1U);
  ASSERT_EQ(received.at(kImu).size(), sent.size());
  for (std::size_t i = 0; i < sent.size(); ++i)
    EXPECT_EQ(without_padding(received.at(kImu)[i], sent[i].size()), sent[i]) << i;
  EXPECT_EQ(reader.lost(), 0U);
}

}  // namespace
}  // namespace lidarena::dds

#else

TEST(FastDds, IsTheOtherSide) { GTEST_SKIP() << "Fast DDS (libfastrtps-dev) was not found"; }

#endif
