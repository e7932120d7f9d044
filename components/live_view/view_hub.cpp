// SPDX-License-Identifier: Apache-2.0
#include "components/live_view/view_hub.hpp"

#include <algorithm>
#include <span>

#include "components/live_view/foxglove_texts.hpp"

namespace strata::live_view {
namespace {

constexpr std::size_t kMaxWriters = 64;
/// A viewer that asks without reading the answers gets no more of them.
constexpr std::size_t kMaxAnswers = 1000;

}  // namespace

ViewHub::ViewHub(std::string name, CommandNames commands, std::size_t max_viewers)
    : name_(std::move(name)), commands_(std::move(commands)), max_viewers_(max_viewers) {
  using Kind = ViewCommand::Kind;
  add_service(Kind::kRelocalize, commands_.relocalize_service, "std_srvs/srv/Empty");
}

void ViewHub::add_service(ViewCommand::Kind kind, const std::string& name, const char* type) {
  if (name.empty()) return;
  services_.push_back({static_cast<std::uint32_t>(kind), kind, name, type});
}

void ViewHub::tell_services_since(std::size_t before) {
  const std::string told = advertised_services(std::span(services_).subspan(before));
  if (told.empty()) return;
  for (auto& [id, viewer] : viewers_) say(viewer, told);
}

void ViewHub::offer(ViewCommand::Kind kind, const std::string& name, const char* type) {
  const std::lock_guard lock(mutex_);
  const std::size_t before = services_.size();
  add_service(kind, name, type);
  tell_services_since(before);
}

void ViewHub::offer_save() {
  offer(ViewCommand::Kind::kSaveMaps, commands_.save_service, "std_srvs/srv/Trigger");
}

void ViewHub::offer_levels(const std::string& owner) {
  offer(ViewCommand::Kind::kSetLevel, owner + "/set_level", "strata_msgs/srv/SetSiteLevel");
}

void ViewHub::offer_site(const std::string& owner, bool may_change) {
  using Kind = ViewCommand::Kind;
  const std::lock_guard lock(mutex_);
  const std::size_t before = services_.size();
  if (may_change) {
    add_service(Kind::kApproveVersion, owner + "/approve_version",
                "strata_msgs/srv/ApproveSiteVersion");
    add_service(Kind::kActivateVersion, owner + "/activate_version",
                "strata_msgs/srv/ActivateSiteVersion");
    add_service(Kind::kRollBack, owner + "/roll_back", "strata_msgs/srv/RollBackSite");
  }
  add_service(Kind::kVersionMap, owner + "/version_map", "strata_msgs/srv/GetSiteVersionMap");
  tell_services_since(before);
}

std::uint32_t ViewHub::advertise(const std::string& topic, const std::string& type,
                                 const std::string& schema, bool latched) {
  const std::lock_guard lock(mutex_);
  const std::uint32_t id = ++last_channel_;
  const Channel channel{id, topic, type, schema, latched};
  channels_[id].channel = channel;
  for (auto& [viewer_id, viewer] : viewers_) say(viewer, advertised({channel}));
  return id;
}

void ViewHub::withdraw(std::uint32_t channel) {
  const std::lock_guard lock(mutex_);
  if (channels_.erase(channel) == 0) return;
  for (auto& [viewer_id, viewer] : viewers_) {
    std::erase_if(viewer.subscriptions,
                  [&](const auto& entry) { return entry.second.channel == channel; });
    say(viewer, withdrawn(channel));
  }
}

void ViewHub::keep_writers(const std::set<bus::Guid>& alive) {
  const std::lock_guard lock(mutex_);
  for (auto& [id, state] : channels_) {
    auto& latest = state.latest;
    if (latest.empty()) continue;
    const SharedMessage newest = latest.back();
    std::erase_if(latest, [&](const SharedMessage& kept) { return !alive.contains(kept->writer); });
    if (latest.empty()) latest.push_back(newest);
  }
}

void ViewHub::publish(std::uint32_t channel, SharedMessage message) {
  const std::lock_guard lock(mutex_);
  const auto known = channels_.find(channel);
  if (known == channels_.end()) return;
  ChannelState& state = known->second;
  if (state.channel.latched) {
    auto& latest = state.latest;
    const auto same = std::find_if(latest.begin(), latest.end(), [&](const SharedMessage& kept) {
      return kept->writer == message->writer;
    });
    if (same != latest.end()) latest.erase(same);
    if (latest.size() == kMaxWriters) latest.erase(latest.begin());
    latest.push_back(message);
  }
  for (auto& [viewer_id, viewer] : viewers_) {
    for (auto& [id, subscription] : viewer.subscriptions) {
      if (subscription.channel != channel) continue;
      put(subscription, message);
      wake(viewer);
    }
  }
}

void ViewHub::put(Subscription& subscription, const SharedMessage& message) {
  auto& pending = subscription.pending;
  const auto same = std::find_if(pending.begin(), pending.end(), [&](const SharedMessage& kept) {
    return kept->writer == message->writer;
  });
  if (same != pending.end()) {
    pending.erase(same);
    ++counts_.dropped;
  } else if (pending.size() == kMaxWriters) {
    pending.pop_front();
    ++counts_.dropped;
  }
  pending.push_back(message);
}

void ViewHub::wake(Viewer& viewer) {
  if (std::exchange(viewer.is_awake, true)) return;
  viewer.wake();
}

std::vector<std::uint32_t> ViewHub::wanted() const {
  const std::lock_guard lock(mutex_);
  std::vector<std::uint32_t> wanted;
  for (const auto& [viewer_id, viewer] : viewers_) {
    for (const auto& [id, subscription] : viewer.subscriptions) {
      wanted.push_back(subscription.channel);
    }
  }
  std::sort(wanted.begin(), wanted.end());
  wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
  return wanted;
}

std::vector<ViewCommand> ViewHub::take_commands() {
  const std::lock_guard lock(mutex_);
  const std::deque<ViewCommand> taken = std::exchange(waiting_commands_, {});
  return {taken.begin(), taken.end()};
}

void ViewHub::answer(const ViewCommand& command, const std::string& problem,
                     const std::vector<std::uint8_t>& response) {
  const std::lock_guard lock(mutex_);
  const auto found = viewers_.find(command.viewer);
  if (found == viewers_.end()) return;
  if (!problem.empty()) {
    say(found->second, service_failure(command.service_id, command.call, problem));
    return;
  }
  found->second.answers.push_back(
      {true, service_response(command.service_id, command.call, response), nullptr});
  wake(found->second);
}

std::optional<ViewerId> ViewHub::join(std::function<void()> wake_viewer) {
  const std::lock_guard lock(mutex_);
  if (viewers_.size() >= max_viewers_) return std::nullopt;
  const ViewerId id = next_viewer_++;
  Viewer& viewer = viewers_[id];
  viewer.wake = std::move(wake_viewer);
  say(viewer, server_info(name_, commands_, !services_.empty()));
  std::vector<Channel> channels;
  for (const auto& [channel_id, state] : channels_) channels.push_back(state.channel);
  if (!channels.empty()) say(viewer, advertised(channels));
  const std::string services = advertised_services(services_);
  if (!services.empty()) say(viewer, services);
  return id;
}

void ViewHub::leave(ViewerId viewer) {
  const std::lock_guard lock(mutex_);
  viewers_.erase(viewer);
}

void ViewHub::say(Viewer& viewer, const std::string& text) {
  if (viewer.answers.size() >= kMaxAnswers) return;
  viewer.answers.push_back({false, {text.begin(), text.end()}, nullptr});
  wake(viewer);
}

void ViewHub::refuse(Viewer& viewer, const std::string& why) {
  ++counts_.refused;
  say(viewer, status_error(why));
}

std::optional<Frame> ViewHub::next(ViewerId id) {
  const std::lock_guard lock(mutex_);
  const auto found = viewers_.find(id);
  if (found == viewers_.end()) return std::nullopt;
  Viewer& viewer = found->second;
  if (!viewer.answers.empty()) {
    Frame frame = std::move(viewer.answers.front());
    viewer.answers.pop_front();
    return frame;
  }
  // In turn, so that a topic of many messages does not hold up the others.
  auto at = viewer.subscriptions.upper_bound(viewer.last_served);
  for (std::size_t i = 0; i < viewer.subscriptions.size(); ++i, ++at) {
    if (at == viewer.subscriptions.end()) at = viewer.subscriptions.begin();
    auto& pending = at->second.pending;
    if (pending.empty()) continue;
    const SharedMessage message = pending.front();
    pending.pop_front();
    viewer.last_served = at->first;
    ++counts_.sent;
    return Frame{true, message_head(at->first, message->stamp_ns), message};
  }
  viewer.is_awake = false;
  return std::nullopt;
}

ViewHub::Counts ViewHub::counts() const {
  const std::lock_guard lock(mutex_);
  Counts counts = counts_;
  counts.viewers = viewers_.size();
  for (const auto& [viewer_id, viewer] : viewers_) {
    for (const auto& [id, subscription] : viewer.subscriptions) {
      counts.waiting += subscription.pending.size();
    }
  }
  return counts;
}

}  // namespace strata::live_view
