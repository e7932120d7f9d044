// SPDX-License-Identifier: Apache-2.0
#include "tools/doctor/network_findings.hpp"

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <map>
#include <set>

#include "components/bus/names.hpp"

namespace strata::doctor {
namespace {

using bus::DiscoveredEndpoint;
using bus::DiscoveredParticipant;
using bus::Guid;

// Fewer messages, or a smaller share, may be a start, an end or a busy moment.
constexpr std::int64_t kFewestMessages = 10;
constexpr double kSmallestLostShare = 0.01;
// A latched message of megabytes takes so long over a network that does not lose frames.
constexpr double kPatienceForLatched_s = 2.0;

constexpr const char* kWifiAdvice =
    "where frames are lost, give the sender's process `transport: wifi` (docs/networks.md), or a "
    "ROS 2 node a profile with maxMessageSize 1472";

std::string topic_name(const DiscoveredEndpoint& endpoint) {
  const std::string name = bus::topic_from_wire(endpoint.wire_topic);
  return name.empty() ? endpoint.wire_topic : name;
}

/// ROS 2 nodes latch their log for ten seconds only: that nothing of it comes says nothing.
bool keeps_what_it_latches(const DiscoveredEndpoint& writer) {
  return writer.wire_topic != "rt/rosout" && !bus::topic_from_wire(writer.wire_topic).empty();
}

/// Surely on our host. Of other vendors' processes we cannot tell: see where_is.
bool is_here(const Guid& guid, const Guid& self) {
  return bus::vendor_of(guid) == bus::kVendorFastDds && bus::host_of(guid) == bus::host_of(self);
}

/// Of one that is not surely here.
std::string where_is(const Guid& guid) {
  const std::uint16_t vendor = bus::vendor_of(guid);
  return vendor == bus::kVendorFastDds
             ? "on another host"
             : bus::vendor_name(vendor) + ", here or on another host: its GUID does not tell";
}

std::string share_text(std::int64_t lost, std::int64_t sent) {
  char text[64];
  std::snprintf(text, sizeof text, "%lld of %lld messages (%.0f%%)", static_cast<long long>(lost),
                static_cast<long long>(sent),
                100.0 * static_cast<double>(lost) / static_cast<double>(sent));
  return text;
}

/// Who runs it, where it is on our host and has memory to share; else null.
const std::string* sharing_user(const Observed& observed,
                                const DiscoveredParticipant& participant) {
  if (!participant.uses_shared_memory || !is_here(participant.guid, observed.self)) return nullptr;
  const auto found = observed.users.find(participant.guid);
  return found != observed.users.end() ? &found->second : nullptr;
}

bool is_heard(const Observed& observed, const Guid& participant) {
  return std::any_of(observed.heard.begin(), observed.heard.end(), [&](const auto& entry) {
    const Heard& heard = entry.second;
    return (heard.messages > 0 || heard.has_latched) &&
           bus::same_participant(entry.first, participant);
  });
}

}  // namespace

std::vector<Finding> find_losses(const Observed& observed, const NameOf& name_of) {
  std::vector<Finding> findings;
  for (const DiscoveredEndpoint& writer : observed.view.endpoints) {
    if (!writer.writes || is_here(writer.guid, observed.self)) continue;
    const auto found = observed.heard.find(writer.guid);
    const Heard heard = found != observed.heard.end() ? found->second : Heard();
    const std::int64_t sent = heard.last_number - heard.first_number + 1;
    const std::int64_t lost = sent - static_cast<std::int64_t>(heard.messages);
    if (heard.messages > 0 && sent >= kFewestMessages &&
        static_cast<double>(lost) >= kSmallestLostShare * static_cast<double>(sent)) {
      findings.push_back({false, topic_name(writer),
                          share_text(lost, sent) + " of " + name_of(writer.guid) + " (" +
                              where_is(writer.guid) + ") did not come at the first attempt",
                          kWifiAdvice});
    }
    const bool is_latched =
        writer.reliable && writer.transient_local && keeps_what_it_latches(writer);
    if (is_latched && !heard.has_latched && heard.known_s >= kPatienceForLatched_s) {
      findings.push_back({false, topic_name(writer),
                          "is latched by " + name_of(writer.guid) + " (" + where_is(writer.guid) +
                              "), and nothing of it has come in " +
                              std::to_string(static_cast<int>(heard.known_s)) + " s",
                          "nothing may have been published yet; else, from another host, it is "
                          "too large for this network: " +
                              std::string(kWifiAdvice)});
    }
  }
  return findings;
}

std::vector<Finding> find_users_apart(const Observed& observed, const NameOf& name_of) {
  std::map<std::string, Guid> sharers;  // one participant a user
  std::set<std::string> heard;
  std::string own_user;
  for (const DiscoveredParticipant& participant : observed.view.participants) {
    const std::string* user = sharing_user(observed, participant);
    if (user == nullptr) continue;
    if (participant.guid == observed.self) {
      own_user = *user;
      continue;
    }
    sharers.emplace(*user, participant.guid);
    if (is_heard(observed, participant.guid)) heard.insert(*user);
  }
  std::vector<Finding> findings;
  for (auto first = sharers.begin(); first != sharers.end(); ++first) {
    for (auto second = std::next(first); second != sharers.end(); ++second) {
      findings.push_back({true, "users " + first->first + " and " + second->first,
                          "run processes here (" + name_of(first->second) + ", " +
                              name_of(second->second) +
                              ") that nothing of the other's reaches: Fast DDS shares memory "
                              "between processes of one user only",
                          "run all as one user, or one of the two without shared memory "
                          "(docs/networks.md)"});
    }
  }
  for (const auto& [user, guid] : sharers) {
    if (own_user.empty() || user == own_user || heard.count(user) > 0) continue;
    findings.push_back(
        {false, "user " + user,
         "runs " + name_of(guid) + " here, this doctor runs as " + own_user +
             ": it shares memory, so nothing of it is heard",
         "run `strata doctor` as " + user + ", or without the profile that shares memory"});
  }
  return findings;
}

}  // namespace strata::doctor
