// SPDX-License-Identifier: Apache-2.0
// Which topics a recorder reads, and how.
#include <algorithm>

#include "components/bus/recorded_topic.hpp"
#include "components/recorder/recorder.hpp"

namespace strata::recorder {
namespace {

/// So long a topic that is named may take to be published.
constexpr auto kPatience = std::chrono::seconds(5);

void add(const std::string& name, std::string& names) {
  names += (names.empty() ? "" : ", ") + name;
}

}  // namespace

std::map<std::string, bus::PublishedTopic> Recorder::topics_to_record() const {
  return bus::topics_to_record(*context().participant, full_name(), config_.topics);
}

void Recorder::record_what_is_published() {
  const auto topics = topics_to_record();
  unreadable_.keep_only(topics);
  for (const auto& [topic, published] : topics) {
    unpublished_.erase(topic);
    if (unreadable_.read(topic, published, [&] { record(topic, published); })) {
      place_of(topic, &published);
    } else {
      misses_more_ = true;
      is_whole_ = false;
    }
  }
  tell_unpublished();
}

void Recorder::tell_unpublished() {
  const bool is_due = waits_since_ && std::chrono::steady_clock::now() - *waits_since_ > kPatience;
  if (!is_due) return;
  waits_since_.reset();
  if (!unpublished_.empty()) tell_line("nobody publishes " + unpublished());
}

std::string Recorder::unpublished() const {
  std::string names;
  for (const std::string& topic : unpublished_) add(topic, names);
  return names;
}

std::string Recorder::silent() const {
  std::string names;
  for (const std::string& topic : config_.topics) {
    const auto found = recorded_.find(topic);
    const bool has_come = found != recorded_.end() && found->second.has_come;
    if (!has_come && !unpublished_.contains(topic)) add(topic, names);
  }
  return names;
}

void Recorder::record(const std::string& topic, const bus::PublishedTopic& published) {
  if (!recorded_.contains(topic)) begin_reading(topic, published);
  Recorded& recorded = recorded_.at(topic);
  recorded.latched = recorded.latched || published.transient_local;
  if (lockstep() || !recorded.second.is_needed(published)) return;
  const auto take_others = [this, topic](const bus::RawMessage& message) {
    // In a pause what is latched is kept, which these are not.
    if (config_.paused || !recorded_.at(topic).second.takes(message.identity.writer)) return;
    take(topic, message);
  };
  subscribe_raw(topic, published.type, recorded.second.qos(), take_others);
  recorded.second.begin();
}

void Recorder::begin_reading(const std::string& topic, const bus::PublishedTopic& published) {
  const bus::QosProfile qos = bus::qos_to_record(published);
  const auto entry =
      recorded_
          .try_emplace(
              topic, Recorded{published.type, bus::SecondReader(context().participant, topic, qos)})
          .first;
  try {
    subscribe_raw(topic, published.type, qos,
                  [this, topic](const bus::RawMessage& message) { take(topic, message); },
                  {.latched_depth = std::max(1, config_.latched_depth)});
  } catch (...) {
    recorded_.erase(entry);  // it may be tried again
    throw;
  }
}

std::size_t Recorder::place_of(const std::string& topic, const bus::PublishedTopic* offered) {
  Recorded& recorded = recorded_.at(topic);
  if (!recorded.place && bag_) {
    log::BagTopic entry{topic, recorded.type};
    if (offered != nullptr) {
      entry.offered_qos_profiles = bus::offered_qos_text(*offered);
      entry.type_hash = bus::offered_type_hash(*offered);
    }
    recorded.place = bag_->add_topic(entry);
  }
  return recorded.place.value_or(0);
}

}  // namespace strata::recorder
