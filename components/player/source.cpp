// SPDX-License-Identifier: Apache-2.0
#include "components/player/source.hpp"

#include <algorithm>

#include <yaml-cpp/yaml.h>

#include "components/convert/geometry_messages.hpp"
#include "core/base/error.hpp"

namespace strata::player {

bool ScanSource::peek(Duration& since_begin) {
  const auto& observations = player_.observations();
  if (next_ >= observations.size()) return false;
  since_begin = observations[next_].scan.stamp - observations.front().scan.stamp;
  return true;
}

void ScanSource::seek(Duration since_begin) {
  const auto& observations = player_.observations();
  const auto found =
      std::find_if(observations.begin(), observations.end(), [&](const Observation& entry) {
        return entry.scan.stamp - observations.front().scan.stamp >= since_begin;
      });
  next_ = static_cast<std::size_t>(found - observations.begin());
}

BagSource::BagSource(std::filesystem::path bag, const std::vector<std::string>& topics,
                     const Advertise& advertise,
                     std::function<void(const rosgraph_msgs::msg::Clock&)> publish_clock)
    : bag_(std::move(bag)), publish_clock_(std::move(publish_clock)) {
  open();
  for (const log::BagTopic& topic : reader_->topics()) {
    const bool wanted =
        topics.empty() || std::find(topics.begin(), topics.end(), topic.name) != topics.end();
    if (wanted && topic.name != "/clock") writers_[topic.name] = advertise(topic);
  }
  if (writers_.empty()) {
    throw InputError(bag_.string(), "has none of the topics to play", "see `strata info` for its");
  }
}

void BagSource::open() {
  reader_ = log::BagReader::open(bag_);
  fetched_ = false;
}

bool BagSource::fetch() {
  while (!fetched_ && reader_->next(message_)) {
    fetched_ = writers_.count(reader_->topics()[message_.topic].name) > 0;
  }
  if (fetched_ && !has_begin_) {
    begin_ = message_.stamp;
    has_begin_ = true;
  }
  return fetched_;
}

bool BagSource::peek(Duration& since_begin) {
  if (!fetch()) return false;
  since_begin = message_.stamp - begin_;
  return true;
}

void BagSource::step() {
  if (!fetch()) return;
  rosgraph_msgs::msg::Clock clock;
  clock.clock(convert::to_message(message_.stamp));
  publish_clock_(clock);
  writers_.at(reader_->topics()[message_.topic].name)->publish(message_.data);
  fetched_ = false;
}

void BagSource::seek(Duration since_begin) {
  (void)fetch();  // for begin_
  open();
  while (fetch() && message_.stamp - begin_ < since_begin) fetched_ = false;
}

bus::QosProfile recorded_qos(const log::BagTopic& topic) {
  bus::QosProfile qos = bus::qos_profile("default");
  try {
    const YAML::Node profiles = YAML::Load(topic.offered_qos_profiles);
    if (!profiles.IsSequence() || profiles.size() == 0) return qos;
    const YAML::Node first = profiles[0];
    const auto says = [&](const char* key, const char* number, const char* word) {
      const YAML::Node value = first[key];
      return value.IsDefined() && (value.Scalar() == number || value.Scalar() == word);
    };
    if (says("reliability", "2", "best_effort")) qos.reliable = false;
    if (says("durability", "1", "transient_local")) qos.transient_local = true;
    const YAML::Node depth = first["depth"];
    if (depth.IsDefined() && depth.as<int>(0) > 0) qos.depth = depth.as<int>();
  } catch (const YAML::Exception&) {
    return bus::qos_profile("default");  // not said in a way we know
  }
  return qos;
}

}  // namespace strata::player
