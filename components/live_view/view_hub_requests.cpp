// SPDX-License-Identifier: Apache-2.0
// What viewers ask of the hub.
#include <algorithm>

#include <nlohmann/json.hpp>

#include "components/live_view/foxglove_texts.hpp"
#include "components/live_view/view_hub.hpp"
#include "components/live_view/viewer_json.hpp"

namespace strata::live_view {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMaxSubscriptions = 1000;
constexpr std::size_t kMaxOwnChannels = 16;
constexpr std::size_t kMaxCommands = 16;

std::vector<std::uint8_t> bytes_of(std::string_view text) { return {text.begin(), text.end()}; }

}  // namespace

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
  const auto known = channels_.find(channel);
  if (known == channels_.end()) {
    return refuse(viewer, "subscribe: there is no channel " + std::to_string(channel));
  }
  if (viewer.subscriptions.size() >= kMaxSubscriptions || viewer.subscriptions.contains(id)) {
    return refuse(viewer, "subscribe: subscription " + std::to_string(id) +
                              " is there already, or there are too many");
  }
  Subscription& subscription = viewer.subscriptions[id];
  subscription.channel = channel;
  for (const SharedMessage& message : known->second.latest) put(subscription, message);
  if (!subscription.pending.empty()) wake(viewer);
}

}  // namespace strata::live_view
