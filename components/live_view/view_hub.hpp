// SPDX-License-Identifier: Apache-2.0
/// What viewers are told and what they ask for, in Foxglove's WebSocket protocol; knows no sockets.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "components/bus/endpoint.hpp"

namespace strata::live_view {

/// A topic that viewers may subscribe to.
struct Channel {
  std::uint32_t id = 0;
  std::string topic;
  std::string type;    ///< "sensor_msgs/msg/LaserScan"
  std::string schema;  ///< ros2msg
  bool latched = false;
};

/// One message for all viewers.
struct ViewMessage {
  std::uint64_t stamp_ns = 0;  ///< when it was written
  bus::Guid writer{};
  std::vector<std::uint8_t> cdr;
};
using SharedMessage = std::shared_ptr<const ViewMessage>;

/// What goes out as one WebSocket message: `head`, then the message's bytes if there is one.
struct Frame {
  bool is_binary = false;
  std::vector<std::uint8_t> head;
  SharedMessage message;
};

using ViewerId = std::uint64_t;

/// What a viewer wants the robot to do.
struct ViewCommand {
  /// The number of a service is its id.
  enum class Kind {
    kSetPose,
    kRelocalize,
    kSaveMaps,
    kApproveVersion,
    kActivateVersion,
    kRollBack,
    kVersionMap,
    kSetLevel
  };
  Kind kind = Kind::kSetPose;
  std::vector<std::uint8_t> cdr;  ///< a geometry_msgs/PoseWithCovarianceStamped, or a request
  std::string service;            ///< full name; empty: none
  ViewerId viewer = 0;            ///< of a service: who is to be answered, and which call
  std::uint32_t service_id = 0;
  std::uint32_t call = 0;
};

/// A service that viewers may call.
struct ViewService {
  std::uint32_t id = 0;
  ViewCommand::Kind kind = ViewCommand::Kind::kRelocalize;
  std::string name;  ///< full
  std::string type;  ///< "std_srvs/srv/Trigger"
};

/// What viewers may do to the robot; empty names: nothing.
struct CommandNames {
  std::string initial_pose_topic;  ///< full
  std::string relocalize_service;  ///< full
  std::string save_service;        ///< full; offered from offer_save on
};

/// Keeps the newest message of each writer of a subscription for each viewer, at most 64: a viewer
/// that does not keep up is left out of the older ones, which is counted, and nothing waits for it.
/// Thread safe. Protocol: foxglove.websocket.v1, whose messages foxglove.sdk.v1 shares.
class ViewHub {
 public:
  /// max_viewers: join() refuses more.
  ViewHub(std::string name, CommandNames commands, std::size_t max_viewers);

  // The robot's side.
  /// Offers a topic to all viewers, present and future. Returns its id.
  std::uint32_t advertise(const std::string& topic, const std::string& type,
                          const std::string& schema, bool latched);
  /// Takes it back from all viewers, with what they have subscribed of it.
  void withdraw(std::uint32_t channel);
  /// Of those writers that are not alive gives up what is kept of latched topics, but for the
  /// newest message of all of a topic. O(kept messages x log(alive)).
  void keep_writers(const std::set<bus::Guid>& alive);
  /// Offers to have the maps saved, now that somebody would.
  void offer_save();
  /// Offers the site of the component `owner` to all viewers, present and future: maps of its
  /// versions, and where `may_change`, decisions on them.
  void offer_site(const std::string& owner, bool may_change);
  /// Offers to tell the component `owner` on which level of a building it is.
  void offer_levels(const std::string& owner);
  /// O(viewers).
  void publish(std::uint32_t channel, SharedMessage message);
  /// The channels that some viewer is subscribed to.
  [[nodiscard]] std::vector<std::uint32_t> wanted() const;
  /// What viewers asked for since the last time; at most 16 wait, more are refused.
  [[nodiscard]] std::vector<ViewCommand> take_commands();
  /// Answers a service: with an empty problem it is done, and `response` is the CDR that it
  /// answers.
  void answer(const ViewCommand& command, const std::string& problem,
              const std::vector<std::uint8_t>& response);

  // The viewers' side.
  /// wake: called, under the hub's lock, when there is something to send to a viewer that had
  /// nothing; it must only arrange for next() to be called. None: there are max_viewers already.
  [[nodiscard]] std::optional<ViewerId> join(std::function<void()> wake);
  void leave(ViewerId viewer);
  /// A message from a viewer. What is not understood is answered with a status, not more.
  void take(ViewerId viewer, bool is_binary, std::string_view bytes);
  /// What is to be sent next; none: nothing now, wake() will tell.
  [[nodiscard]] std::optional<Frame> next(ViewerId viewer);

  struct Counts {
    std::size_t viewers = 0;
    std::size_t waiting = 0;    ///< messages, of all viewers
    std::uint64_t sent = 0;     ///< messages handed out by next()
    std::uint64_t dropped = 0;  ///< messages that a viewer was too slow for
    std::uint64_t refused = 0;  ///< what viewers sent and was not understood or not allowed
  };
  [[nodiscard]] Counts counts() const;

 private:
  struct Subscription {
    std::uint32_t channel = 0;
    std::deque<SharedMessage> pending;  ///< one a writer
  };
  struct Viewer {
    std::function<void()> wake;
    bool is_awake = false;  ///< somebody will call next() until it has nothing
    std::deque<Frame> answers;
    std::map<std::uint32_t, Subscription> subscriptions;
    std::uint32_t last_served = 0;
    std::map<std::uint32_t, bool> own_channels;  ///< that it publishes on
  };
  struct ChannelState {
    Channel channel;
    std::vector<SharedMessage> latest;  ///< of latched ones, one a writer
  };
  void offer(ViewCommand::Kind kind, const std::string& name, const char* type);
  // All under mutex_.
  void put(Subscription& subscription, const SharedMessage& message);
  static void wake(Viewer& viewer);
  void add_service(ViewCommand::Kind kind, const std::string& name, const char* type);
  void say(Viewer& viewer, const std::string& text);
  void tell_services_since(std::size_t before);
  void refuse(Viewer& viewer, const std::string& why);
  void take_text(Viewer& viewer, std::string_view text);
  void take_call(ViewerId id, Viewer& viewer, std::string_view bytes);
  void subscribe(Viewer& viewer, std::uint32_t subscription, std::uint32_t channel);
  void add_command(Viewer& viewer, ViewCommand command);

  const std::string name_;
  const CommandNames commands_;
  const std::size_t max_viewers_;
  mutable std::mutex mutex_;
  std::map<std::uint32_t, ChannelState> channels_;  ///< by id
  std::uint32_t last_channel_ = 0;
  std::vector<ViewService> services_;
  std::map<ViewerId, Viewer> viewers_;
  ViewerId next_viewer_ = 1;
  std::deque<ViewCommand> waiting_commands_;
  Counts counts_;
};

}  // namespace strata::live_view
