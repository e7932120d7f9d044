// SPDX-License-Identifier: Apache-2.0
#include "components/topologies/topology_messages.hpp"

#include <utility>

#include "components/convert/geometry_messages.hpp"
#include "core/base/error.hpp"

namespace strata::convert {

strata_msgs::msg::Topologies to_message(std::span<const topology::TopologySummary> topologies,
                                        std::span<const Stamp> visits, const std::string& frame) {
  strata_msgs::msg::Topologies message;
  message.header(make_header(visits.empty() ? Stamp() : visits.back(), frame));
  for (const Stamp stamp : visits) message.visits().push_back(to_message(stamp));
  for (const topology::TopologySummary& summary : topologies) {
    strata_msgs::msg::Topology entry;
    entry.probability(summary.probability);
    entry.log_evidence(summary.log_evidence);
    entry.labels().assign(summary.labels.begin(), summary.labels.end());
    for (const Pose2Gaussian& landmark : summary.landmarks) {
      entry.landmarks().push_back(to_message(landmark));
    }
    message.topologies().push_back(std::move(entry));
  }
  return message;
}

std::vector<topology::TopologySummary> from_message(const strata_msgs::msg::Topologies& message) {
  std::vector<topology::TopologySummary> topologies;
  for (const auto& entry : message.topologies()) {
    topology::TopologySummary summary;
    summary.probability = entry.probability();
    summary.log_evidence = entry.log_evidence();
    summary.labels.assign(entry.labels().begin(), entry.labels().end());
    for (const auto& landmark : entry.landmarks()) {
      summary.landmarks.push_back(from_message(landmark));
    }
    const bool fits = summary.labels.size() == message.visits().size() &&
                      topology::is_canonical(summary.labels) &&
                      static_cast<std::size_t>(topology::landmark_count(summary.labels)) ==
                          summary.landmarks.size();
    if (!fits) {
      throw InputError("Topologies", "labels fit neither the visits nor the landmarks",
                       "check the sender's version");
    }
    topologies.push_back(std::move(summary));
  }
  return topologies;
}

}  // namespace strata::convert
