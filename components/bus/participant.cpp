// SPDX-License-Identifier: Apache-2.0
#include "components/bus/participant.hpp"

#include <algorithm>
#include <chrono>
#include <utility>
#include <vector>

#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/rtps/transport/shared_mem/SharedMemTransportDescriptor.h>

#include "components/bus/names.hpp"
#include "components/bus/participant_state.hpp"
#include "components/bus/process_limits.hpp"
#include "components/bus/process_participants.hpp"
#include "components/bus/raw_type.hpp"
#include "components/bus/security.hpp"
#include "components/bus/shared_memory.hpp"
#include "components/bus/transports.hpp"
#include "core/base/error.hpp"

namespace strata::bus {
namespace {

bool shares_memory(const dds::TransportConfigQos& transport) {
  using Memory = eprosima::fastdds::rtps::SharedMemTransportDescriptor;
  const auto& own = transport.user_transports;
  return transport.use_builtin_transports ||
         std::any_of(own.begin(), own.end(), [](const auto& descriptor) {
           return dynamic_cast<const Memory*>(descriptor.get()) != nullptr;
         });
}

}  // namespace

std::string user_data_value(const std::vector<rtps::octet>& user_data, const std::string& key) {
  const std::string text(user_data.begin(), user_data.end());
  const std::size_t begin = text.find(key + "=");
  if (begin == std::string::npos) return {};
  const std::size_t first = begin + key.size() + 1;
  return text.substr(first, text.find(';', first) - first);
}

Participant::Participant(const ParticipantOptions& options) : state_(std::make_shared<State>()) {
  if (options.domain < 0 || options.domain > 232) {
    throw ConfigError("domain", "is " + std::to_string(options.domain),
                      "choose a ROS_DOMAIN_ID from 0 to 232");
  }
  state_->options = options;
  require_room_for_participant();
  dds::DomainParticipantQos qos = participant_qos(options);
  if (shares_memory(qos.transport())) remove_orphaned_segments();
  if (options.transport == Transport::kSharedMemory) {
    state_->shared_ports = std::make_unique<SharedPortClaim>(options.domain);
  }
  const bool is_unseen = options.transport == Transport::kAlone;
  state_->is_secured = !is_unseen && secure(options, qos);
  if (is_unseen) {
    state_->alone_id = ProcessParticipants::instance().take_alone_id();
    qos.wire_protocol().participant_id = *state_->alone_id;
  }
  auto* factory = dds::DomainParticipantFactory::get_instance();
  ProcessParticipants::instance().add(state_);  // first: it may lack memory
  // Who sees nobody is on no domain; the ports of the first have room for its number.
  const auto domain = static_cast<dds::DomainId_t>(is_unseen ? 0 : options.domain);
  state_->participant =
      factory->create_participant(domain, qos, state_.get(), dds::StatusMask::none());
  if (state_->participant != nullptr) {
    state_->publisher = state_->participant->create_publisher(dds::PUBLISHER_QOS_DEFAULT);
    state_->subscriber = state_->participant->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT);
  }
  if (state_->publisher == nullptr || state_->subscriber == nullptr) {
    delete_entities();
    throw OutputError("domain " + std::to_string(options.domain), "no DDS participant can be made",
                      state_->is_secured
                          ? "see what Fast DDS says above; make the enclave again with `strata "
                            "keystore` if it is at fault"
                          : "check the network interfaces and free ports above 7400");
  }
}

Participant::~Participant() {
  if (state_->participant == nullptr) return;
  const Guid removed = guid();
  state_->leave();
  delete_entities();
  ProcessParticipants::instance().remove(removed, state_);
}

void Participant::delete_entities() {
  if (state_->participant != nullptr) {
    state_->participant->set_listener(nullptr);
    state_->participant->delete_contained_entities();
    dds::DomainParticipantFactory::get_instance()->delete_participant(state_->participant);
    state_->participant = nullptr;
  }
  if (!state_->alone_id) return;
  ProcessParticipants::instance().give_back_alone_id(*state_->alone_id);
  state_->alone_id.reset();
}

const ParticipantOptions& Participant::options() const { return state_->options; }

bool Participant::is_secured() const { return state_->is_secured; }

std::vector<std::string> Participant::warnings() const {
  std::vector<std::string> warnings;
  const ParticipantOptions& options = state_->options;
  if (options.security.enabled && !is_secured() && options.transport != Transport::kAlone) {
    warnings.push_back("runs without security: enclave " + options.enclave +
                       " is not in the keystore and ROS_SECURITY_STRATEGY is not Enforce");
  }
  if (options.transport != Transport::kSharedMemory && state_->uses_shared_memory()) {
    warnings.emplace_back(
        "a Fast DDS profile of yours shares memory: a process of another release of Fast DDS, or "
        "any user of this host, can end this one; take shared memory out of the profile, as in "
        "packaging/udp_only.xml");
  }
  return warnings;
}

Guid Participant::guid() const { return to_guid(state_->participant->guid()); }

std::map<std::string, PublishedTopic> Participant::published_topics() const {
  const std::lock_guard lock(state_->mutex);
  if (!state_->offers_now) state_->offers_now = state_->offers();
  return *state_->offers_now;
}

std::map<std::string, PublishedTopic> Participant::State::offers() const {
  const auto is_readable = [this](const DiscoveredEndpoint& endpoint) {
    const auto used = topics.find(endpoint.wire_topic);
    return used == topics.end() || used->second.topic->get_type_name() == endpoint.wire_type;
  };
  const Guid own = to_guid(participant->guid());
  std::map<std::string, PublishedTopic> result;
  const auto add = [&](const DiscoveredEndpoint& endpoint) {
    const std::string topic = topic_from_wire(endpoint.wire_topic);
    const std::string type = type_from_wire(endpoint.wire_type);
    if (!endpoint.writes || topic.empty() || type.empty()) return;
    const bool is_own = same_participant(endpoint.guid, own);
    const PublishedTopic offered{
        type, endpoint.reliable, endpoint.transient_local, is_own, {endpoint}};
    const auto [entry, is_first] = result.insert({topic, offered});
    PublishedTopic& published = entry->second;
    if (is_first || published.type != type) return;
    published.reliable = published.reliable && offered.reliable;
    published.transient_local = published.transient_local && offered.transient_local;
    published.is_own = published.is_own || offered.is_own;
    published.writers.push_back(endpoint);
  };
  for (const bool is_wanted : {true, false}) {
    for (const auto& [guid, endpoint] : endpoints) {
      if (is_readable(endpoint) == is_wanted) add(endpoint);
    }
  }
  return result;
}

bool Participant::is_answered(const std::string& service) const {
  const std::string reply = wire_topic({service, TopicKind::kReply});
  const std::lock_guard lock(state_->mutex);
  return std::any_of(state_->endpoints.begin(), state_->endpoints.end(), [&](const auto& known) {
    return known.second.writes && known.second.wire_topic == reply;
  });
}

DomainView Participant::view() const {
  const std::lock_guard lock(state_->mutex);
  DomainView view;
  const std::string& enclave = state_->options.enclave;
  view.participants.push_back({guid(), enclave, enclave, state_->uses_shared_memory()});
  for (const auto& [guid, participant] : state_->participants) {
    view.participants.push_back(participant);
  }
  for (const auto& [guid, endpoint] : state_->endpoints) view.endpoints.push_back(endpoint);
  return view;
}

bool Participant::State::uses_shared_memory() const {
  return shares_memory(participant->get_qos().transport());
}

const Caught& Participant::caught() const { return state_->caught; }

void Participant::set_before_endpoint(std::function<void(const std::string&)> check) {
  const std::lock_guard lock(state_->mutex);
  state_->before_endpoint = std::move(check);
}

void Participant::State::wait_until_forgotten(const Guid& guid,
                                              std::chrono::steady_clock::time_point deadline) {
  std::unique_lock lock(mutex);
  forgot.wait_until(lock, deadline, [&] { return is_leaving || !participants.contains(guid); });
}

void Participant::State::leave() {
  const std::lock_guard lock(mutex);
  is_leaving = true;
  forgot.notify_all();
}

void Participant::State::add_endpoint(const DiscoveredEndpoint& endpoint) {
  const std::lock_guard lock(mutex);
  endpoints[endpoint.guid] = endpoint;
  offers_now.reset();
}

void Participant::State::remove_endpoint(const Guid& guid) {
  const std::lock_guard lock(mutex);
  endpoints.erase(guid);
  offers_now.reset();
}

void Participant::State::on_participant_discovery(dds::DomainParticipant* /*participant*/,
                                                  rtps::ParticipantDiscoveryInfo&& info) {
  caught.run([&] { take_participant(info); });
}

void Participant::State::take_participant(const rtps::ParticipantDiscoveryInfo& info) {
  using Info = rtps::ParticipantDiscoveryInfo;
  const Guid guid = to_guid(info.info.m_guid);
  const std::lock_guard lock(mutex);
  if (info.status == Info::REMOVED_PARTICIPANT || info.status == Info::DROPPED_PARTICIPANT) {
    participants.erase(guid);
    forgot.notify_all();
    return;
  }
  const auto& addresses = info.info.default_locators.unicast;
  const bool uses_shared_memory =
      std::any_of(addresses.begin(), addresses.end(),
                  [](const rtps::Locator_t& address) { return address.kind == LOCATOR_KIND_SHM; });
  DiscoveredParticipant found{guid, info.info.m_participantName.to_string(),
                              user_data_value(info.info.m_userData.getValue(), "enclave"),
                              uses_shared_memory};
  for (const auto& locators : {addresses, info.info.metatraffic_locators.unicast}) {
    for (const rtps::Locator_t& address : locators) {
      found.ports.push_back(static_cast<std::uint16_t>(address.port & 0xFFFFU));
    }
  }
  participants[guid] = std::move(found);
}

void Participant::State::on_publisher_discovery(dds::DomainParticipant* /*participant*/,
                                                rtps::WriterDiscoveryInfo&& info) {
  caught.run([&] {
    if (info.status == rtps::WriterDiscoveryInfo::REMOVED_WRITER) {
      remove_endpoint(to_guid(info.info.guid()));
    } else {
      add_endpoint(describe_endpoint(info.info, true));
    }
  });
}

void Participant::State::on_subscriber_discovery(dds::DomainParticipant* /*participant*/,
                                                 rtps::ReaderDiscoveryInfo&& info) {
  caught.run([&] {
    if (info.status == rtps::ReaderDiscoveryInfo::REMOVED_READER) {
      remove_endpoint(to_guid(info.info.guid()));
    } else {
      add_endpoint(describe_endpoint(info.info, false));
    }
  });
}

}  // namespace strata::bus
