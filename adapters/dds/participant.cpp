// SPDX-License-Identifier: BSD-3-Clause
#include "adapters/dds/participant.hpp"

#include <charconv>
#include <cstdlib>
#include <utility>

#include "lidarena/base/error.hpp"

namespace lidarena::dds {
namespace {

constexpr int kMaxDomain = 232;  // the ports of later ones do not exist
constexpr std::string_view kTopicPrefix = "rt/";
constexpr std::string_view kTypeInfix = "::dds_::";

/// One interface, no multicast, fragments as large as a datagram may be. A cloud of 3 MB overflows
/// the usual buffers of a socket; what is missing is asked for at once (default: after 100 ms).
constexpr const char* kLoopback = R"(<CycloneDDS><Domain id="any">
<General><Interfaces><NetworkInterface name="lo" multicast="false"/></Interfaces>
<AllowMulticast>false</AllowMulticast><MaxMessageSize>65500B</MaxMessageSize>
<FragmentSize>60000B</FragmentSize></General>
<Internal><SocketReceiveBufferSize max="32MB"/><NackDelay>2ms</NackDelay></Internal>
<Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>50</MaxAutoParticipantIndex>
<Peers><Peer address="127.0.0.1"/></Peers></Discovery>
</Domain></CycloneDDS>)";

dds_domainid_t domain_of(const LiveOptions& options) {
  if (options.domain >= 0) return static_cast<dds_domainid_t>(options.domain);
  const char* text = std::getenv("ROS_DOMAIN_ID");
  if (text == nullptr || *text == '\0') return 0;
  const std::string_view digits(text);
  int domain = -1;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), domain);
  if (error != std::errc() || end != digits.data() + digits.size() || domain < 0 ||
      domain > kMaxDomain) {
    throw InputError("ROS_DOMAIN_ID", "is '" + std::string(digits) + "'",
                     "set it to a number from 0 to 232, or remove it");
  }
  return static_cast<dds_domainid_t>(domain);
}

}  // namespace

Entity::Entity(dds_entity_t entity, const std::string& what) : entity_(entity) {
  if (entity < 0) throw Error(what + ": " + dds_strretcode(entity));
}
Entity::~Entity() {
  if (entity_ > 0) dds_delete(entity_);
}
Entity::Entity(Entity&& other) noexcept : entity_(std::exchange(other.entity_, 0)) {}
Entity& Entity::operator=(Entity&& other) noexcept {
  std::swap(entity_, other.entity_);
  return *this;
}

Participant::Participant(const LiveOptions& options) {
  const dds_domainid_t domain = domain_of(options);
  if (!options.network && std::getenv("CYCLONEDDS_URI") == nullptr) {
    const dds_entity_t created = dds_create_domain(domain, kLoopback);
    // Of several participants in a process the first one configures the domain.
    if (created != DDS_RETCODE_PRECONDITION_NOT_MET) domain_ = Entity(created, "live topics");
  }
  participant_ = Entity(dds_create_participant(domain, nullptr, nullptr), "live topics");
}

std::string dds_topic_of(std::string_view ros_topic) {
  if (ros_topic.starts_with('/')) ros_topic.remove_prefix(1);
  return std::string(kTopicPrefix) + std::string(ros_topic);
}

std::string ros_topic_of(std::string_view dds_topic) {
  if (!dds_topic.starts_with(kTopicPrefix)) return {};
  return "/" + std::string(dds_topic.substr(kTopicPrefix.size()));
}

std::string dds_type_of(std::string_view ros_type) {
  std::string name;
  const std::size_t last = ros_type.rfind('/');
  for (const char c : ros_type.substr(0, last))
    name += c == '/' ? std::string("::") : std::string(1, c);
  return name + std::string(kTypeInfix) + std::string(ros_type.substr(last + 1)) + "_";
}

std::string ros_type_of(std::string_view dds_type) {
  const std::size_t infix = dds_type.find(kTypeInfix);
  if (infix == std::string_view::npos || !dds_type.ends_with('_')) return {};
  std::string name;
  for (std::size_t i = 0; i < infix; ++i) {
    if (dds_type[i] == ':') ++i;
    name += dds_type[i] == ':' ? '/' : dds_type[i];
  }
  const std::size_t begin = infix + kTypeInfix.size();
  return name + "/" + std::string(dds_type.substr(begin, dds_type.size() - begin - 1));
}

}  // namespace lidarena::dds
