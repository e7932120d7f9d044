// SPDX-License-Identifier: Apache-2.0
/// ROS 2's graph: which nodes a participant holds, and which endpoints are theirs. Each participant
/// tells it whole on the latched topic `ros_discovery_info`; `ros2 node list` reads nothing else.
#pragma once

#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "components/bus/domain_view.hpp"
#include "components/bus/endpoint.hpp"

namespace strata::bus {

/// A node as the graph tells it.
struct NodeInfo {
  std::string node_namespace;  ///< "/" or "/robot1"
  std::string name;
  std::vector<Guid> readers;
  std::vector<Guid> writers;
  friend bool operator==(const NodeInfo&, const NodeInfo&) = default;
};

class GraphWriter;

/// Announces one node while it lives. Thread safe.
class Node {
 public:
  Node(const std::shared_ptr<Participant>& participant, std::string node_namespace,
       std::string name);
  /// Takes the node off the graph.
  ~Node();
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;

  /// Says which endpoints are the node's; sent when that changed.
  void announce(std::vector<Guid> readers, std::vector<Guid> writers);

 private:
  std::shared_ptr<GraphWriter> graph_;
  NodeInfo info_;
};

/// The nodes that others, and this participant, announce.
class GraphReader {
 public:
  explicit GraphReader(std::shared_ptr<Participant> participant);
  /// By participant, as of now.
  [[nodiscard]] std::map<Guid, std::vector<NodeInfo>> nodes() const;
  /// Waits until a node of that full name ("/robot1/localizer") is there; false at the timeout.
  [[nodiscard]] bool wait_for_node(const std::string& full_name,
                                   std::chrono::milliseconds timeout) const;

 private:
  void take(const RawMessage& message);
  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  std::map<Guid, std::vector<NodeInfo>> nodes_;
  std::unique_ptr<RawReader> reader_;  // last: its callback uses the others
};

/// How many bytes a Gid has on the wire of that release: 24 up to Humble, 16 from Iron on. Throws
/// ConfigError for a release it does not know.
[[nodiscard]] std::size_t gid_bytes_of(std::string_view ros_distro);

}  // namespace strata::bus
