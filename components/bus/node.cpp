// SPDX-License-Identifier: Apache-2.0
#include "components/bus/node.hpp"

#include <algorithm>
#include <array>

#include "components/bus/graph_message.hpp"
#include "components/bus/participant_state.hpp"
#include "core/base/error.hpp"

namespace strata::bus {
namespace {

constexpr const char* kGraphTopic = "ros_discovery_info";
constexpr const char* kGraphType = "rmw_dds_common/msg/ParticipantEntitiesInfo";

std::string full_name_of(const NodeInfo& node) {
  return (node.node_namespace == "/" ? "" : node.node_namespace) + "/" + node.name;
}

}  // namespace

/// All nodes of one participant; lives as long as one of them.
class GraphWriter {
 public:
  explicit GraphWriter(const std::shared_ptr<Participant>& participant)
      : participant_guid_(participant->guid()),
        gid_bytes_(gid_bytes_of(participant->options().ros_distro)),
        writer_(participant, TopicName::plain(kGraphTopic), kGraphType, qos_profile("latched")) {}

  void put(const Node* node, const NodeInfo& info) {
    const std::lock_guard lock(mutex_);
    nodes_[node] = info;
    send();
  }
  void remove(const Node* node) noexcept {
    (void)caught_.run([&] {
      const std::lock_guard lock(mutex_);
      nodes_.erase(node);
      send();
    });
  }

 private:
  void send() {
    std::vector<NodeInfo> nodes;
    for (const auto& [node, info] : nodes_) nodes.push_back(info);
    writer_.publish(graph_to_cdr(participant_guid_, nodes, gid_bytes_));
  }

  Guid participant_guid_;
  std::size_t gid_bytes_;
  std::mutex mutex_;
  std::map<const Node*, NodeInfo> nodes_;
  Caught caught_;  // at the end of a node, where nobody can be told
  RawWriter writer_;
};

namespace {

std::shared_ptr<GraphWriter> graph_of(const std::shared_ptr<Participant>& participant) {
  Participant::State& state = participant->state();
  const std::lock_guard lock(state.graph_mutex);
  std::shared_ptr<GraphWriter> graph = state.graph.lock();
  if (!graph) {
    graph = std::make_shared<GraphWriter>(participant);
    state.graph = graph;
  }
  return graph;
}

}  // namespace

Node::Node(const std::shared_ptr<Participant>& participant, std::string node_namespace,
           std::string name)
    : graph_(graph_of(participant)),
      info_{node_namespace.empty() ? "/" : std::move(node_namespace), std::move(name), {}, {}} {
  try {
    graph_->put(this, info_);
  } catch (...) {
    graph_->remove(this);
    throw;
  }
}

Node::~Node() { graph_->remove(this); }

void Node::announce(std::vector<Guid> readers, std::vector<Guid> writers) {
  if (readers == info_.readers && writers == info_.writers) return;
  NodeInfo news{info_.node_namespace, info_.name, std::move(readers), std::move(writers)};
  graph_->put(this, news);
  info_ = std::move(news);  // now: what could not be sent is sent again
}

GraphReader::GraphReader(std::shared_ptr<Participant> participant) {
  QosProfile qos = qos_profile("latched");
  qos.depth = 0;  // the topic has no key: keep-last would keep one participant's message only
  reader_ =
      std::make_unique<RawReader>(std::move(participant), TopicName::plain(kGraphTopic), kGraphType,
                                  qos, [this](const RawMessage& message) { take(message); });
}

void GraphReader::take(const RawMessage& message) {
  auto graph = graph_from_cdr(message.cdr);
  if (!graph) return;
  const std::lock_guard lock(mutex_);
  nodes_[graph->first] = std::move(graph->second);
  changed_.notify_all();
}

std::map<Guid, std::vector<NodeInfo>> GraphReader::nodes() const {
  const std::lock_guard lock(mutex_);
  return nodes_;
}

bool GraphReader::wait_for_node(const std::string& full_name,
                                std::chrono::milliseconds timeout) const {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, timeout, [&] {
    return std::any_of(nodes_.begin(), nodes_.end(), [&](const auto& entry) {
      return std::any_of(entry.second.begin(), entry.second.end(),
                         [&](const NodeInfo& node) { return full_name_of(node) == full_name; });
    });
  });
}

std::size_t gid_bytes_of(std::string_view ros_distro) {
  constexpr std::array<const char*, 3> kWith24 = {"foxy", "galactic", "humble"};
  constexpr std::array<const char*, 5> kWith16 = {"iron", "jazzy", "kilted", "lyrical", "rolling"};
  const auto is = [&](const char* name) { return ros_distro == name; };
  if (std::any_of(kWith24.begin(), kWith24.end(), is)) return 24;
  if (std::any_of(kWith16.begin(), kWith16.end(), is)) return 16;
  throw ConfigError("ros_distro", "unknown ROS 2 release '" + std::string(ros_distro) + "'",
                    "use foxy, galactic, humble, iron, jazzy, kilted, lyrical or rolling");
}

}  // namespace strata::bus
