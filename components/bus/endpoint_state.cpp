// SPDX-License-Identifier: Apache-2.0
#include "components/bus/endpoint_state.hpp"

#include <algorithm>

#include "components/convert/type_hash.hpp"
#include "core/base/error.hpp"

namespace strata::bus {

std::string hash_of(const TopicName& topic, const std::string& type) {
  if (topic.kind == TopicKind::kPlain) return convert::type_hash(type);
  return convert::type_hash(topic.kind == TopicKind::kTopic ? type
                                                            : type.substr(0, type.rfind('_')));
}

void require_granted(const QosProfile& asked, const QosProfile& granted, const std::string& topic) {
  if (asked.reliable == granted.reliable && asked.transient_local == granted.transient_local &&
      asked.depth == granted.depth) {
    return;
  }
  throw OutputError(topic, "the middleware changed the QoS profile '" + asked.name + "'",
                    "remove XML profiles that override endpoints");
}

void refuse(const Participant::State& owner, const TopicName& topic, const QosProfile& qos,
            bool writes) {
  const std::string verb = writes ? "write" : "read";
  if (!owner.is_secured) {
    throw OutputError(topic.full,
                      std::string("no ") + (writes ? "writer" : "reader") + " can be made",
                      "check the QoS profile " + qos.name);
  }
  throw OutputError(
      topic.full, "enclave " + owner.options.enclave + " may not " + verb + " " + wire_topic(topic),
      "allow it with `strata keystore permissions`");
}

SampleIdentity from_wire(const rtps::SampleIdentity& identity) {
  const rtps::SequenceNumber_t& number = identity.sequence_number();
  if (identity.writer_guid() == rtps::GUID_t::unknown()) return {};
  return {to_guid(identity.writer_guid()), static_cast<std::int64_t>(number.to64long())};
}

rtps::SampleIdentity to_wire(const SampleIdentity& identity) {
  rtps::GUID_t guid;
  std::copy_n(identity.writer.begin(), 12, guid.guidPrefix.value);
  std::copy_n(identity.writer.begin() + 12, 4, guid.entityId.value);
  rtps::SampleIdentity result;
  result.writer_guid(guid);
  result.sequence_number(
      rtps::SequenceNumber_t(static_cast<std::int32_t>(identity.sequence_number >> 32),
                             static_cast<std::uint32_t>(identity.sequence_number & 0xFFFFFFFF)));
  return result;
}

}  // namespace strata::bus
