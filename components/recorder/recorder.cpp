// SPDX-License-Identifier: Apache-2.0
#include "components/recorder/recorder.hpp"

#include <algorithm>

namespace strata::recorder {

void Recorder::on_configure() {
  config_ = read_parameters<RecorderConfig>();
  bag_ = std::make_unique<log::BagWriter>(
      config_.out, config_.storage == "mcap" ? log::BagStorage::kMcap : log::BagStorage::kSqlite3);
  for (std::string& topic : config_.topics) {
    const std::size_t colon = topic.find(':');
    const std::string type = colon == std::string::npos ? "" : topic.substr(colon + 1);
    topic = resolve(topic.substr(0, colon));
    // Nobody may publish it yet: best effort and volatile, which matches every writer.
    if (!type.empty()) record(topic, {type, false, false});
  }
  on_tick();
}

void Recorder::on_tick() {
  for (const auto& [topic, published] : context().participant->published_topics()) {
    // What tells of the recorder itself is no part of what it records.
    const bool is_own = topic.starts_with(full_name() + "/");
    if (is_own || topic.starts_with("/strata_lockstep/")) continue;
    const bool wanted =
        config_.topics.empty() ||
        std::find(config_.topics.begin(), config_.topics.end(), topic) != config_.topics.end();
    if (wanted) record(topic, published);
  }
}

void Recorder::record(const std::string& topic, const bus::PublishedTopic& published) {
  if (recorded_.count(topic) > 0) return;
  const std::size_t place = bag_->add_topic({topic, published.type, "cdr", ""});
  recorded_[topic] = place;
  bus::QosProfile qos = bus::qos_profile("sensor_data");
  qos.reliable = published.reliable;
  qos.transient_local = published.transient_local;  // the laser's mounting was sent long ago
  qos.depth = 1000;  // a burst must not push messages out before they are written
  subscribe_raw(topic, published.type, qos, [this, place](const bus::RawMessage& message) {
    bag_->write(place, Stamp{message.source_stamp_ns}, message.cdr);
  });
}

void Recorder::on_deactivate() { bag_->close(); }

void Recorder::on_cleanup() {
  bag_.reset();
  recorded_.clear();
}

}  // namespace strata::recorder
