// SPDX-License-Identifier: Apache-2.0
/// What writers and readers have in common below their interface.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "components/bus/endpoint.hpp"
#include "components/bus/match_count.hpp"
#include "components/bus/participant_state.hpp"

namespace strata::bus {

/// Of a writer or a reader of the middleware.
template <typename Endpoint>
struct EndpointState {
  explicit EndpointState(std::function<void()> on_match) : matches(std::move(on_match)) {}
  ~EndpointState() {
    if (participant) participant->state().give_back(used);
  }
  EndpointState(const EndpointState&) = delete;
  EndpointState& operator=(const EndpointState&) = delete;

  void matched(int now, const dds::InstanceHandle_t& other, int change) {
    participant->state().caught.run(
        [&] { matches.set(now, to_guid(rtps::iHandle2GUID(other)), change > 0); });
  }

  std::shared_ptr<Participant> participant;
  std::string topic;
  std::string profile;
  dds::Topic* used = nullptr;  ///< given back after the endpoint
  Endpoint* endpoint = nullptr;
  MatchCount matches;
};

/// The hash of a type that we know, on a topic of ROS 2; both topics of a service tell that of the
/// whole service.
[[nodiscard]] std::string hash_of(const TopicName& topic, const std::string& type);

/// Sets what writers and readers have in common.
template <typename EndpointQos>
void apply_profile(const QosProfile& profile, const std::string& type_hash, EndpointQos& qos) {
  if (!type_hash.empty()) {
    const std::string text = "typehash=" + type_hash + ";";
    qos.user_data().setValue(std::vector<rtps::octet>(text.begin(), text.end()));
  }
  qos.reliability().kind =
      profile.reliable ? dds::RELIABLE_RELIABILITY_QOS : dds::BEST_EFFORT_RELIABILITY_QOS;
  qos.durability().kind =
      profile.transient_local ? dds::TRANSIENT_LOCAL_DURABILITY_QOS : dds::VOLATILE_DURABILITY_QOS;
  qos.history().kind = profile.depth == 0 ? dds::KEEP_ALL_HISTORY_QOS : dds::KEEP_LAST_HISTORY_QOS;
  if (profile.depth > 0) qos.history().depth = profile.depth;
  // Our types are unbounded: the plain policy would make every write fail.
  qos.endpoint().history_memory_policy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  qos.data_sharing().off();
}

template <typename EndpointQos>
QosProfile profile_of(const std::string& name, const EndpointQos& qos) {
  QosProfile result;
  result.name = name;
  result.reliable = qos.reliability().kind == dds::RELIABLE_RELIABILITY_QOS;
  result.transient_local = qos.durability().kind == dds::TRANSIENT_LOCAL_DURABILITY_QOS;
  result.depth = qos.history().kind == dds::KEEP_ALL_HISTORY_QOS ? 0 : qos.history().depth;
  return result;
}

/// Throws OutputError when the middleware gave something else than was asked for.
void require_granted(const QosProfile& asked, const QosProfile& granted, const std::string& topic);

/// Says why the middleware made no endpoint: throws OutputError.
[[noreturn]] void refuse(const Participant::State& owner, const TopicName& topic,
                         const QosProfile& qos, bool writes);

[[nodiscard]] SampleIdentity from_wire(const rtps::SampleIdentity& identity);
[[nodiscard]] rtps::SampleIdentity to_wire(const SampleIdentity& identity);

}  // namespace strata::bus
