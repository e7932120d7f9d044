// SPDX-License-Identifier: Apache-2.0
#include "components/player/source.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>

#include <yaml-cpp/yaml.h>

#include "components/convert/geometry_messages.hpp"
#include "components/log/ros_stamps.hpp"
#include "core/base/error.hpp"

namespace strata::player {
namespace {

constexpr std::size_t kHeaderBytes = 4;  // of every message

}  // namespace

Duration since(Stamp begin, Stamp stamp) {
  Duration result;
  if (!__builtin_sub_overflow(stamp.ns, begin.ns, &result.ns)) return result;
  constexpr auto kMax = std::numeric_limits<std::int64_t>::max();
  return {stamp > begin ? kMax : -kMax};
}

bool ScanSource::peek(Duration& since_begin) {
  const auto& observations = player_.observations();
  if (next_ >= observations.size()) return false;
  since_begin = since(observations.front().scan.stamp, observations[next_].scan.stamp);
  return true;
}

bool ScanSource::seek(Duration since_begin) {
  const auto& observations = player_.observations();
  const auto found =
      std::find_if(observations.begin(), observations.end(), [&](const Observation& entry) {
        return since(observations.front().scan.stamp, entry.scan.stamp) >= since_begin;
      });
  if (found == observations.end()) return false;
  next_ = static_cast<std::size_t>(found - observations.begin());
  return true;
}

std::optional<Stamp> ScanSource::begin() {
  if (player_.observations().empty()) return std::nullopt;
  return player_.observations().front().scan.stamp;
}

BagSource::BagSource(std::filesystem::path bag, const std::vector<std::string>& topics,
                     const Advertise& advertise, std::stop_token stop,
                     std::function<void(const rosgraph_msgs::msg::Clock&)> publish_clock)
    : bag_(std::move(bag)),
      stop_(std::move(stop)),
      publish_clock_(std::move(publish_clock)),
      reader_(log::BagReader::open(bag_)) {
  for (const log::BagTopic& topic : reader_->topics()) {
    // Nobody on DDS could read what ROS 1 serialized.
    if (topic.serialization_format == log::kRos1Format) continue;
    const bool wanted =
        topics.empty() || std::find(topics.begin(), topics.end(), topic.name) != topics.end();
    if (wanted && topic.name != "/clock") writers_[topic.name] = advertise(topic);
  }
  if (writers_.empty()) {
    throw InputError(bag_.string(), "has none of the topics to play",
                     "see `strata info` for those it has");
  }
}

bool BagSource::read_played(log::BagReader& reader, log::BagMessage& message) const {
  while (!stop_.stop_requested() && reader.next(message)) {
    const log::BagTopic& topic = reader.topics()[message.topic];
    const bool is_ours = topic.serialization_format != log::kRos1Format;
    if (is_ours && writers_.count(topic.name) > 0) return true;
  }
  return false;
}

bool BagSource::fetch() {
  fetched_ = fetched_ || read_played(*reader_, message_);
  if (fetched_ && !begin_) begin_ = message_.stamp;
  return fetched_;
}

bool BagSource::peek(Duration& since_begin) {
  if (!fetch()) return false;
  since_begin = since(*begin_, message_.stamp);
  return true;
}

std::optional<Stamp> BagSource::begin() {
  if (!begin_) (void)fetch();
  return begin_;
}

void BagSource::step() {
  if (!fetch()) return;
  const std::string& topic = reader_->topics()[message_.topic].name;
  log::require_ros_stamp(message_.stamp, bag_.string() + ": a message of " + topic);
  rosgraph_msgs::msg::Clock clock;
  clock.clock(convert::to_message(message_.stamp));
  publish_clock_(clock);
  if (message_.data.size() < kHeaderBytes) {
    ++left_out_;
  } else {
    writers_.at(topic)->publish(message_.data);
  }
  fetched_ = false;
}

bool BagSource::seek(Duration since_begin) {
  if (!begin()) return false;
  auto reader = log::BagReader::open(bag_);
  log::BagMessage message;
  while (read_played(*reader, message)) {
    if (since(*begin_, message.stamp) < since_begin) continue;
    reader_ = std::move(reader);
    message_ = std::move(message);
    fetched_ = true;
    return true;
  }
  return false;
}

bus::QosProfile recorded_qos(const log::BagTopic& topic) {
  bus::QosProfile qos = bus::qos_profile("default");
  try {
    const YAML::Node profiles = YAML::Load(topic.offered_qos_profiles);
    if (!profiles.IsSequence() || profiles.size() == 0) return qos;
    qos.reliable = false;
    for (const YAML::Node& profile : profiles) {
      const auto says = [&](const char* key, const char* number, const char* word) {
        const YAML::Node value = profile[key];
        return value.IsDefined() && (value.Scalar() == number || value.Scalar() == word);
      };
      if (!says("reliability", "2", "best_effort")) qos.reliable = true;
      if (says("durability", "1", "transient_local")) qos.transient_local = true;
    }
    const YAML::Node depth = profiles[0]["depth"];
    if (depth.IsDefined() && depth.as<int>(0) > 0) qos.depth = depth.as<int>();
  } catch (const YAML::Exception&) {
    return bus::qos_profile("default");  // not said in a way we know
  }
  return qos;
}

}  // namespace strata::player
