// SPDX-License-Identifier: Apache-2.0
#include "components/recorder/recorder.hpp"

#include <algorithm>

#include "components/bus/bag_service_types.hpp"
#include "components/convert/geometry_messages.hpp"

namespace strata::recorder {
namespace {

constexpr auto kFlushPeriod = std::chrono::milliseconds(500);

log::BagOptions bag_options(const RecorderConfig& config) {
  log::BagOptions options;
  options.storage = config.storage;
  options.chunks = config.compression;
  options.sqlite_schema = config.sqlite_schema;
  options.split_bytes = static_cast<std::uint64_t>(config.split_mb * 1e6);
  options.split_after = Duration::from_seconds(config.split_s);
  return options;
}

/// The folder to write: the one that is asked for or, when it may be numbered, the first free one.
std::filesystem::path free_folder(const RecorderConfig& config, bool may_number) {
  std::filesystem::path folder = config.out;
  for (int number = 2; may_number && std::filesystem::exists(folder); ++number) {
    folder = config.out + "_" + std::to_string(number);
  }
  return folder;
}

/// rosbag2's text for a QoS profile, with its numbers for the words. Discovery does not tell the
/// history, which rosbag2 then writes as unknown (3) and 0; times are without limit.
std::string offered_qos(const bus::PublishedTopic& published) {
  const std::string forever = "\n    sec: 9223372036\n    nsec: 854775807";
  return std::string("- history: 3\n  depth: 0\n  reliability: ") +
         (published.reliable ? "1" : "2") +
         "\n  durability: " + (published.transient_local ? "1" : "2") + "\n  deadline:" + forever +
         "\n  lifespan:" + forever + "\n  liveliness: 1\n  liveliness_lease_duration:" + forever +
         "\n  avoid_ros_namespace_conventions: false";
}

}  // namespace

void Recorder::on_configure() {
  config_ = read_parameters<RecorderConfig>();
  recorded_.clear();
  log_time_.reset();
  if (!context().only_explained) {
    // Configured again, it finds its own bag there.
    const bool may_number = config_.number_if_exists || has_recorded_;
    bag_ = std::make_unique<log::BagWriter>(free_folder(config_, may_number), bag_options(config_));
    has_recorded_ = true;
  }
  if (lockstep()) {
    subscribe<rosgraph_msgs::msg::Clock>("/clock", "clock", [this](const auto& message) {
      log_time_ = convert::from_message(message.clock());
    });
  }
  serve();
  const auto published = context().participant->published_topics();
  for (std::string& topic : config_.topics) {
    const std::size_t colon = topic.find(':');
    const std::string type = colon == std::string::npos ? "" : topic.substr(colon + 1);
    topic = resolve(topic.substr(0, colon));
    if (type.empty()) continue;
    const auto found = published.find(topic);
    // Nobody may publish it yet: best effort and volatile, which matches every writer.
    record(topic,
           found == published.end() ? bus::PublishedTopic{type, false, false} : found->second);
  }
  record_what_is_published();
}

void Recorder::serve() {
  keep_live<RecorderConfig>(
      {"paused"}, [this](const RecorderConfig& config) { config_.paused = config.paused; });
  offer<bus::srv::Pause>("~/pause", [this](const auto&) {
    set_paused(true);
    return rosbag2_interfaces::srv::Pause_Response();
  });
  offer<bus::srv::Resume>("~/resume", [this](const auto&) {
    set_paused(false);
    return rosbag2_interfaces::srv::Resume_Response();
  });
  offer<bus::srv::IsPaused>("~/is_paused", [this](const auto&) {
    rosbag2_interfaces::srv::IsPaused_Response response;
    response.paused(config_.paused);
    return response;
  });
  offer<bus::srv::SplitBagfile>("~/split_bagfile", [this](const auto&) {
    if (bag_) bag_->close();  // the next message begins another file of the bag
    return rosbag2_interfaces::srv::SplitBagfile_Response();
  });
}

void Recorder::set_paused(bool paused) {
  rcl_interfaces::msg::Parameter parameter;
  parameter.name("paused");
  parameter.value(runtime::parameter_value(paused));
  (void)set_parameters({parameter});
}

void Recorder::on_tick() {
  record_what_is_published();
  const auto now = std::chrono::steady_clock::now();
  if (!bag_ || now - flushed_ < kFlushPeriod) return;
  bag_->flush();
  flushed_ = now;
}

void Recorder::record_what_is_published() {
  for (const auto& [topic, published] : context().participant->published_topics()) {
    // What tells of the recorder itself is no part of what it records.
    const bool is_own = topic.starts_with(full_name() + "/");
    if (is_own || topic.starts_with("/strata_lockstep/")) continue;
    const bool wanted =
        config_.topics.empty() ||
        std::find(config_.topics.begin(), config_.topics.end(), topic) != config_.topics.end();
    if (!wanted) continue;
    record(topic, published);
    place_of(topic, &published);
  }
}

void Recorder::record(const std::string& topic, const bus::PublishedTopic& published) {
  if (!recorded_.try_emplace(topic, Recorded{published.type, std::nullopt}).second) return;
  bus::QosProfile qos = bus::qos_profile("sensor_data");
  qos.reliable = published.reliable;
  qos.transient_local = published.transient_local;  // the laser's mounting was sent long ago
  qos.depth = 1000;  // a burst must not push messages out before they are written
  subscribe_raw(topic, published.type, qos,
                [this, topic](const bus::RawMessage& message) { write(topic, message); });
}

std::size_t Recorder::place_of(const std::string& topic, const bus::PublishedTopic* offered) {
  Recorded& recorded = recorded_.at(topic);
  if (!recorded.place && bag_) {
    recorded.place = bag_->add_topic(
        {topic, recorded.type, "cdr", offered == nullptr ? "" : offered_qos(*offered)});
  }
  return recorded.place.value_or(0);
}

void Recorder::write(const std::string& topic, const bus::RawMessage& message) {
  if (!bag_ || config_.paused) return;
  if (!recorded_.at(topic).place) {
    const auto published = context().participant->published_topics();
    const auto found = published.find(topic);
    place_of(topic, found == published.end() ? nullptr : &found->second);
  }
  const Stamp stamp = log_time_.value_or(Stamp{message.source_stamp_ns});
  bag_->write(*recorded_.at(topic).place, stamp, message.cdr);
}

void Recorder::on_deactivate() {
  if (bag_) bag_->close();
}

void Recorder::on_cleanup() {
  bag_.reset();
  recorded_.clear();
}

}  // namespace strata::recorder
