// SPDX-License-Identifier: Apache-2.0
#include "components/live_view/view_hub.hpp"

#include <algorithm>
#include <span>

#include <nlohmann/json.hpp>

#include "components/live_view/foxglove_texts.hpp"
#include "components/live_view/viewer_json.hpp"

namespace strata::live_view {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMaxWriters = 64;
constexpr std::size_t kMaxSubscriptions = 1000;
constexpr std::size_t kMaxOwnChannels = 16;
/// A viewer that asks without reading the answers gets no more of them.
constexpr std::size_t kMaxAnswers = 1000;
constexpr std::size_t kMaxCommands = 16;

std::vector<std::uint8_t> bytes_of(std::string_view text) { return {text.begin(), text.end()}; }

}  // namespace

ViewHub::ViewHub(std::string name, CommandNames commands, std::size_t max_viewers)
    : name_(std::move(name)), commands_(std::move(commands)), max_viewers_(max_viewers) {
  using Kind = ViewCommand::Kind;
  add_service(Kind::kRelocalize, commands_.relocalize_service, "std_srvs/srv/Empty");
  add_service(Kind::kSaveMaps, commands_.save_service, "std_srvs/srv/Trigger");
}

void ViewHub::add_service(ViewCommand::Kind kind, const std::string& name, const char* type) {
  if (name.empty()) return;
  services_.push_back({static_cast<std::uint32_t>(kind), kind, name, type});
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
  const std::string told = advertised_services(std::span(services_).subspan(before));
  for (auto& [id, viewer] : viewers_) say(viewer, told);
}

std::uint32_t ViewHub::advertise(const std::string& topic, const std::string& type,
                                 const std::string& schema, bool latched) {
  const std::lock_guard lock(mutex_);
  const auto id = static_cast<std::uint32_t>(channels_.size() + 1);
  channels_.push_back({{id, topic, type, schema, latched}, {}});
  for (auto& [viewer_id, viewer] : viewers_) say(viewer, advertised({channels_.back().channel}));
  return id;
}

void ViewHub::publish(std::uint32_t channel, SharedMessage message) {
  const std::lock_guard lock(mutex_);
  ChannelState& state = channels_.at(channel - 1);
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
  for (const ChannelState& state : channels_) channels.push_back(state.channel);
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
  viewer.answers.push_back({false, bytes_of(text), nullptr});
  wake(viewer);
}

void ViewHub::refuse(Viewer& viewer, const std::string& why) {
  ++counts_.refused;
  say(viewer, status_error(why));
}

void ViewHub::take(ViewerId id, bool is_binary, std::string_view bytes) {
  const std::lock_guard lock(mutex_);
  const auto found = viewers_.find(id);
  if (found == viewers_.end()) return;
  Viewer& viewer = found->second;
  if (!is_binary) {
    take_text(viewer, bytes);
    return;
  }
  constexpr std::size_t kHead = 1 + sizeof(std::uint32_t);
  if (bytes.size() < kHead) return refuse(viewer, "a binary message is too short");
  const auto opcode = static_cast<ClientOpcode>(bytes.front());
  if (opcode == ClientOpcode::kServiceRequest) return take_call(id, viewer, bytes);
  if (opcode != ClientOpcode::kMessage)
    return refuse(viewer, "a binary message has no such opcode");
  if (!viewer.own_channels.contains(number_at(bytes, 1))) {
    return refuse(viewer, "a message came on a channel that was not advertised");
  }
  ViewCommand command;
  command.cdr = bytes_of(bytes.substr(kHead));
  command.viewer = id;
  add_command(viewer, std::move(command));
}

void ViewHub::take_call(ViewerId id, Viewer& viewer, std::string_view bytes) {
  constexpr std::size_t kNumber = sizeof(std::uint32_t);
  constexpr std::size_t kHead = 1 + 3 * kNumber;  // opcode, service, call, length of the encoding
  const std::uint32_t wanted = bytes.size() < kHead ? 0 : number_at(bytes, 1);
  const auto service = std::find_if(services_.begin(), services_.end(),
                                    [&](const ViewService& one) { return one.id == wanted; });
  if (service == services_.end()) return refuse(viewer, "there is no such service");
  const std::size_t encoding = number_at(bytes, 1 + 2 * kNumber);
  if (encoding > bytes.size() - kHead) return refuse(viewer, "a service call is too short");
  ViewCommand command;
  command.kind = service->kind;
  command.service = service->name;
  command.cdr = bytes_of(bytes.substr(kHead + encoding));
  command.viewer = id;
  command.service_id = service->id;
  command.call = number_at(bytes, 1 + kNumber);
  add_command(viewer, std::move(command));
}

void ViewHub::add_command(Viewer& viewer, ViewCommand command) {
  if (waiting_commands_.size() >= kMaxCommands) return refuse(viewer, "too many requests wait");
  waiting_commands_.push_back(std::move(command));
}

void ViewHub::take_text(Viewer& viewer, std::string_view text) {
  const Json json = Json::parse(text.begin(), text.end(), nullptr, false);
  if (!json.is_object()) return refuse(viewer, "a text message is no JSON object");
  const std::string op = string_of(json, "op");
  if (op == "subscribe") {
    for (const Json& entry : list_of(json, "subscriptions")) {
      const auto id = number_of(entry, "id");
      const auto channel = number_of(entry, "channelId");
      if (!id || !channel) return refuse(viewer, "subscribe: needs id and channelId");
      subscribe(viewer, *id, *channel);
    }
  } else if (op == "unsubscribe") {
    for (const Json& id : list_of(json, "subscriptionIds")) {
      if (const auto number = number_of(id)) viewer.subscriptions.erase(*number);
    }
  } else if (op == "advertise") {
    for (const Json& entry : list_of(json, "channels")) {
      const auto id = number_of(entry, "id");
      const bool is_pose = !commands_.initial_pose_topic.empty() &&
                           string_of(entry, "topic") == commands_.initial_pose_topic &&
                           string_of(entry, "schemaName") == kInitialPoseType &&
                           string_of(entry, "encoding") == "cdr";
      if (!id || !is_pose || viewer.own_channels.size() >= kMaxOwnChannels) {
        return refuse(viewer, "advertise: viewers may publish " +
                                  (commands_.initial_pose_topic.empty()
                                       ? std::string("nothing")
                                       : commands_.initial_pose_topic + " only, as " +
                                             kInitialPoseType + " in cdr"));
      }
      viewer.own_channels[*id] = true;
    }
  } else if (op == "unadvertise") {
    for (const Json& id : list_of(json, "channelIds")) {
      if (const auto number = number_of(id)) viewer.own_channels.erase(*number);
    }
  } else if (op != "clientInfo") {
    refuse(viewer, "this server does not know that op");
  }
}

void ViewHub::subscribe(Viewer& viewer, std::uint32_t id, std::uint32_t channel) {
  if (channel == 0 || channel > channels_.size()) {
    return refuse(viewer, "subscribe: there is no channel " + std::to_string(channel));
  }
  if (viewer.subscriptions.size() >= kMaxSubscriptions || viewer.subscriptions.contains(id)) {
    return refuse(viewer, "subscribe: subscription " + std::to_string(id) +
                              " is there already, or there are too many");
  }
  Subscription& subscription = viewer.subscriptions[id];
  subscription.channel = channel;
  for (const SharedMessage& message : channels_[channel - 1].latest) put(subscription, message);
  if (!subscription.pending.empty()) wake(viewer);
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
