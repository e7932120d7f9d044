// SPDX-License-Identifier: Apache-2.0
/// What the bus keeps of Fast DDS; for the bus's own .cpp files only.
#pragma once

#include <map>
#include <mutex>
#include <string>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>

#include "components/bus/participant.hpp"

namespace strata::bus {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;

struct Participant::State : dds::DomainParticipantListener {
  ParticipantOptions options;
  dds::DomainParticipant* participant = nullptr;
  dds::Publisher* publisher = nullptr;
  dds::Subscriber* subscriber = nullptr;
  /// The topic's entity, made at its first use and kept: Fast DDS allows one a name.
  dds::Topic* topic(const std::string& full_name, const std::string& type);
  void add_local_writer(const rtps::GUID_t& guid, const std::string& full_name,
                        const PublishedTopic& published);
  void remove_local_writer(const rtps::GUID_t& guid);

  void on_publisher_discovery(dds::DomainParticipant* participant,
                              rtps::WriterDiscoveryInfo&& info) override;

  mutable std::mutex mutex;
  std::map<std::string, dds::Topic*> topics;
  /// Own and others' writers: Fast DDS announces only those of others.
  std::map<rtps::GUID_t, std::pair<std::string, PublishedTopic>> writers;
};

}  // namespace strata::bus
