// SPDX-License-Identifier: Apache-2.0
/// A process's place on a DDS domain. One a process: each has threads and sockets of its own.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "components/bus/caught.hpp"
#include "components/bus/domain_view.hpp"

namespace strata::bus {

enum class Transport {
  kDefault,          ///< UDP with multicast discovery, as ROS 2 uses between hosts
  kLocalhost,        ///< finds this host's processes and static peers only, without multicast
  kLoopback,         ///< UDP on 127.0.0.1 only, no multicast
  kSharedMemory,     ///< shared memory only: our own processes of one user on one host
  kWifi,             ///< as default, each datagram one frame: where frames are lost
  kDiscoveryServer,  ///< as default, with the servers that an option or ROS_DISCOVERY_SERVER names
  kAlone,            ///< finds nobody and is found by nobody: to look at a composition
};

/// Their names, as users write them, for a text: "default, localhost, ... or discovery_server".
[[nodiscard]] std::string transport_names();
/// Throws ConfigError for a name that is none.
[[nodiscard]] Transport transport_from_name(std::string_view name);
/// kAlone: "alone", which nobody can ask for.
[[nodiscard]] std::string_view transport_name(Transport transport);
/// Whether it asks static peers: one that keeps to itself, or asks a server, does not.
[[nodiscard]] bool asks_static_peers(Transport transport);

/// As ROS 2's variables ROS_SECURITY_ENABLE, _STRATEGY and _KEYSTORE say.
struct SecurityOptions {
  bool enabled = false;
  bool enforced = false;  ///< no participant without an enclave; else one that is missing is fine
  std::string keystore;   ///< folder in SROS2's layout
};

struct ParticipantOptions {
  int domain = 0;  ///< ROS_DOMAIN_ID, 0 to 232
  Transport transport = Transport::kDefault;
  std::string enclave = "/";  ///< ROS 2's name of the security enclave, also the participant's name
  std::string ros_distro = "jazzy";       ///< whose layout ros_discovery_info has
  std::vector<std::string> static_peers;  ///< IPv4 addresses or host names to ask besides
  std::string discovery_server;           ///< "10.0.0.5:11811"; empty: what the environment says
  bool is_alone = false;                  ///< sees this process only
  SecurityOptions security;               ///< with kAlone never used
};

/// What the writers of a topic offer. Where they do not agree on a type: those of the type that
/// this participant has it with, which is the only one that it can read.
struct PublishedTopic {
  std::string type;              ///< "sensor_msgs/msg/LaserScan"
  bool reliable = false;         ///< all of them
  bool transient_local = false;  ///< all of them
  bool is_own = false;           ///< one of them is this participant's
  std::vector<DiscoveredEndpoint> writers = {};
};

/// Discovers others and owns the middleware's entities. Thread safe.
class Participant {
 public:
  /// Throws ConfigError for a domain out of range, a peer or server without an address and a
  /// transport without what it needs, InputError for an enclave that is not good, OutputError when
  /// the middleware refuses.
  explicit Participant(const ParticipantOptions& options);
  /// Returns when the others of this process no longer see it: a datagram's time, 5 s if it is
  /// lost.
  ~Participant();
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;

  [[nodiscard]] const ParticipantOptions& options() const;
  [[nodiscard]] Guid guid() const;
  /// Whether it has shown its enclave; false where a permissive one was not there.
  [[nodiscard]] bool is_secured() const;
  /// What its user is to know: no security though it was asked for, memory shared by a profile.
  [[nodiscard]] std::vector<std::string> warnings() const;
  /// Every ROS 2 topic that some writer of the domain, here or elsewhere, publishes now.
  [[nodiscard]] std::map<std::string, PublishedTopic> published_topics() const;
  /// Whether somebody, here or elsewhere, answers that service now (its full name). O(endpoints).
  [[nodiscard]] bool is_answered(const std::string& service) const;
  /// Everything that discovery knows now, this participant and its endpoints included.
  [[nodiscard]] DomainView view() const;

  /// What callbacks of this participant's endpoints threw, and was stopped.
  [[nodiscard]] const Caught& caught() const;
  /// For tests: called with the topic's name on the wire before each writer or reader is made; what
  /// it throws, the endpoint's constructor throws.
  void set_before_endpoint(std::function<void(const std::string&)> check);

  struct State;
  /// For endpoints.
  [[nodiscard]] State& state() { return *state_; }

 private:
  void delete_entities();
  std::shared_ptr<State> state_;
};

}  // namespace strata::bus
