// SPDX-License-Identifier: Apache-2.0
// Which topics viewers are offered, and which of them are read.
#include <algorithm>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "components/bus/recorded_topic.hpp"
#include "components/bus/site_service_types.hpp"
#include "components/convert/message_definitions.hpp"
#include "components/live_view/live_view.hpp"

namespace strata::live_view {
namespace {

constexpr std::string_view kSiteTopic = "/site_versions";
constexpr std::string_view kLevelTopic = "/level";
/// Messages of one topic that may come between two looks of the component.
constexpr int kDepth = 20;
/// Which writers are alive is asked so often: it takes long.
constexpr auto kWritersPeriod = std::chrono::seconds(5);

}  // namespace

void LiveView::offer_topics() {
  Topics topics = context().participant->published_topics();
  std::erase_if(topics, [](const auto& entry) {
    return entry.first.starts_with("/strata_lockstep/") || bus::is_hidden(entry.first);
  });
  unreadable_.keep_only(topics);
  forget_topics(topics);
  forget_writers();
  left_out_ = 0;
  for (const auto& [topic, published] : topics) {
    if (offered_.contains(topic)) {
      read_others(topic, published);
      continue;
    }
    if (has_room()) {
      offer(topic, published);
    } else {
      ++left_out_;
    }
  }
}

void LiveView::forget_topics(const Topics& published) {
  const Clock::time_point now = Clock::now();
  const std::chrono::duration<double> patience(config_.forget_after_s);
  for (auto next = offered_.begin(); next != offered_.end();) {
    const auto topic = next++;
    const auto found = published.find(topic->first);
    std::optional<Clock::time_point>& gone_since = topic->second.gone_since;
    if (found != published.end()) {
      gone_since.reset();
      if (found->second.type != topic->second.type) give_up(topic);
      continue;
    }
    if (!gone_since) gone_since = now;
    if (!config_.keep_newest && now - *gone_since >= patience) give_up(topic);
  }
}

/// Publishers that begin again and again leave a latched message each.
void LiveView::forget_writers() {
  const Clock::time_point now = Clock::now();
  if (now - writers_looked_at_ < kWritersPeriod) return;
  writers_looked_at_ = now;
  std::set<bus::Guid> alive;
  for (const auto& endpoint : context().participant->view().endpoints) {
    if (endpoint.writes) alive.insert(endpoint.guid);
  }
  hub_->keep_writers(alive);
}

/// What has been gone for longest gives way to what is there.
bool LiveView::has_room() {
  if (offered_.size() < static_cast<std::size_t>(config_.max_topics)) return true;
  const auto when = [](const auto& entry) {
    return entry.second.gone_since.value_or(Clock::time_point::max());
  };
  const auto oldest =
      std::min_element(offered_.begin(), offered_.end(),
                       [&](const auto& a, const auto& b) { return when(a) < when(b); });
  if (!oldest->second.gone_since) return false;
  give_up(oldest);
  return true;
}

void LiveView::give_up(std::map<std::string, Offered>::iterator topic) {
  if (topic->second.channel != 0) hub_->withdraw(topic->second.channel);
  if (topic->second.is_read) unsubscribe(topic->first);
  offered_.erase(topic);
}

void LiveView::offer(const std::string& topic, const bus::PublishedTopic& published) {
  Offered& offered = offered_[topic];
  offered.type = published.type;
  offered.latched = published.transient_local;
  if (!has_site_ && topic.ends_with(kSiteTopic) &&
      published.type == bus::MessageType<strata_msgs::msg::SiteVersions>::name) {
    has_site_ = true;
    hub_->offer_site(topic.substr(0, topic.size() - kSiteTopic.size()), config_.allow_commands);
  }
  if (config_.allow_commands && !has_levels_ && topic.ends_with(kLevelTopic) &&
      published.type == bus::MessageType<strata_msgs::msg::SiteLevel>::name) {
    has_levels_ = true;
    hub_->offer_levels(topic.substr(0, topic.size() - kLevelTopic.size()));
  }
  const std::string schema = convert::message_definition(published.type);
  if (schema.empty()) return;  // nobody could decode it
  offered.channel =
      hub_->advertise(topic, published.type, schema, offered.latched || config_.keep_newest);
}

void LiveView::read_what_is_wanted() {
  const std::vector<std::uint32_t> wanted = hub_->wanted();
  for (auto& [topic, offered] : offered_) {
    if (offered.is_read || offered.channel == 0) continue;
    if (!config_.keep_newest &&
        !std::binary_search(wanted.begin(), wanted.end(), offered.channel)) {
      continue;
    }
    bus::QosProfile qos = bus::qos_profile("sensor_data");
    qos.reliable = offered.latched;
    qos.transient_local = offered.latched;
    qos.depth = kDepth;
    offered.second.emplace(context().participant, topic, qos);
    const auto give = [this, channel = offered.channel](const bus::RawMessage& message) {
      this->give(channel, message);
    };
    offered.is_read = unreadable_.read(
        topic, {offered.type, offered.latched, offered.latched},
        [&] { subscribe_raw(topic, offered.type, qos, give, {.latched_depth = 1}); });
  }
}

void LiveView::give(std::uint32_t channel, const bus::RawMessage& message) {
  hub_->publish(channel, std::make_shared<const ViewMessage>(
                             ViewMessage{static_cast<std::uint64_t>(message.source_stamp_ns),
                                         message.identity.writer, message.cdr}));
}

void LiveView::read_others(const std::string& topic, const bus::PublishedTopic& published) {
  Offered& offered = offered_.at(topic);
  if (!offered.is_read || !offered.second->is_needed(published)) return;
  const auto take = [this, topic, channel = offered.channel](const bus::RawMessage& message) {
    const auto found = offered_.find(topic);
    if (found == offered_.end() || !found->second.second) return;
    if (found->second.second->takes(message.identity.writer)) give(channel, message);
  };
  const bus::QosProfile qos = offered.second->qos();
  if (unreadable_.read(topic, published, [&] { subscribe_raw(topic, offered.type, qos, take); })) {
    offered.second->begin();
  }
}

}  // namespace strata::live_view
