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
  void add_local_writer(const std::string& full_name, const std::string& type);
  void remove_local_writer(const std::string& full_name);

  void on_publisher_discovery(dds::DomainParticipant* participant,
                              rtps::WriterDiscoveryInfo&& info) override;

  struct Published {
    std::string type;
    int writers = 0;
  };
  mutable std::mutex mutex;
  std::map<std::string, dds::Topic*> topics;
  std::map<std::string, Published> local;  // by full name: Fast DDS announces only remote writers
  std::map<rtps::GUID_t, std::pair<std::string, std::string>> remote;
};

}  // namespace strata::bus
