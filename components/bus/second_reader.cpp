// SPDX-License-Identifier: Apache-2.0
#include "components/bus/second_reader.hpp"

#include <algorithm>
#include <utility>

namespace strata::bus {
namespace {

/// Writers may come and go for as long as a robot runs.
constexpr std::size_t kMaxWriters = 1000;

}  // namespace

bool offers_less(const DiscoveredEndpoint& writer, const QosProfile& asked) {
  return (asked.reliable && !writer.reliable) || (asked.transient_local && !writer.transient_local);
}

QosProfile qos_of_second(const QosProfile& first) {
  QosProfile qos = qos_profile("sensor_data");
  qos.depth = first.depth;
  return qos;
}

SecondReader::SecondReader(std::shared_ptr<const Participant> participant, std::string topic,
                           QosProfile first)
    : participant_(std::move(participant)), topic_(std::move(topic)), first_(std::move(first)) {}

bool SecondReader::is_needed(const PublishedTopic& published) {
  if (is_there_) return false;
  return std::any_of(published.writers.begin(), published.writers.end(),
                     [&](const auto& writer) { return offers_less(writer, first_); });
}

void SecondReader::look(const PublishedTopic& published) {
  if (offers_less_.size() > kMaxWriters) offers_less_.clear();
  for (const DiscoveredEndpoint& writer : published.writers) {
    offers_less_[writer.guid] = offers_less(writer, first_);
  }
}

bool SecondReader::takes(const Guid& writer) {
  const auto known = offers_less_.find(writer);
  if (known != offers_less_.end()) return known->second;
  const auto published = participant_->published_topics();
  if (const auto found = published.find(topic_); found != published.end()) look(found->second);
  // One that is gone already: rather twice than not at all.
  return offers_less_.try_emplace(writer, true).first->second;
}

}  // namespace strata::bus
