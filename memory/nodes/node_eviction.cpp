// SPDX-License-Identifier: Apache-2.0
/// Nodes that are not in memory: how they are evicted and loaded, and how a snapshot is decoded in
/// spite of them.
#include <algorithm>
#include <iomanip>
#include <sstream>
#include <string>

#include "memory/decoding/decode.hpp"
#include "memory/nodes/timescale_memory.hpp"

namespace strata::memory {
namespace {

std::string place_of(const MemoryNode& node, std::size_t index) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(1) << "node " << index << " at (" << node.position_m.x()
       << ", " << node.position_m.y() << ") m";
  return text.str();
}

}  // namespace

std::vector<std::uint64_t> MemoryNode::revisions() const {
  std::vector<std::uint64_t> result{observations};
  for (const NodeLevel& level : levels) result.push_back(level.insertions());
  if (today) result.push_back(today->revision());
  return result;
}

std::size_t TimescaleMemory::resident() const {
  return static_cast<std::size_t>(std::count_if(
      nodes_.begin(), nodes_.end(), [](const auto& node) { return !node.is_evicted(); }));
}

MemoryNode TimescaleMemory::loaded(std::size_t index) const {
  MemoryNode node = nodes_[index];
  allocate(node);
  try {
    read_levels(node, source_->levels_of(index), source_->place());
  } catch (const DamageError& error) {
    throw DamageError(error.place() + ": " + place_of(node, index), error.problem(),
                      error.remedy());
  }
  node.stored_revisions = node.revisions();
  return node;
}

void TimescaleMemory::load(int index) {
  const auto n = static_cast<std::size_t>(index);
  if (!nodes_[n].is_evicted()) return;
  try {
    nodes_[n] = loaded(n);
  } catch (const DamageError&) {
    pass_over(n);
    throw;
  }
}

void TimescaleMemory::evict(std::size_t max_resident, std::shared_ptr<const NodeSource> source) {
  std::vector<std::size_t> up;
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    if (!nodes_[n].is_evicted()) up.push_back(n);
  }
  if (up.size() <= max_resident) return;
  source_ = std::move(source);
  std::stable_sort(up.begin(), up.end(), [this](std::size_t a, std::size_t b) {
    return nodes_[a].last_used < nodes_[b].last_used;
  });
  up.resize(up.size() - max_resident);
  for (const std::size_t n : up) {
    MemoryNode& node = nodes_[n];
    node.stored_revisions = node.revisions();
    node.levels = {};
    node.today.reset();
  }
}

std::vector<bool> TimescaleMemory::to_read(const NodeMap* previous, std::size_t most) const {
  std::vector<std::size_t> missing;
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    const bool is_known =
        previous != nullptr && n < previous->nodes().size() && !previous->nodes()[n].is_pending;
    if (nodes_[n].is_evicted() && !nodes_[n].is_damaged && !is_known) missing.push_back(n);
  }
  if (missing.size() > most) {
    const Eigen::Vector2d here = nodes_[newest_node_].position_m;
    std::nth_element(missing.begin(), missing.begin() + static_cast<std::ptrdiff_t>(most),
                     missing.end(), [&](std::size_t a, std::size_t b) {
                       const double to_a = (nodes_[a].position_m - here).squaredNorm();
                       const double to_b = (nodes_[b].position_m - here).squaredNorm();
                       return to_a != to_b ? to_a < to_b : a < b;
                     });
    missing.resize(most);
  }
  std::vector<bool> result(nodes_.size(), false);
  for (const std::size_t n : missing) result[n] = true;
  return result;
}

std::optional<MemoryNode> TimescaleMemory::read_for(const DecodeRules& rules,
                                                    std::size_t index) const {
  if (nodes_[index].is_damaged) return std::nullopt;
  try {
    return loaded(index);
  } catch (const DamageError& error) {
    if (rules.damaged == nullptr) throw;
    rules.damaged->push_back({index, error});
    return std::nullopt;
  }
}

NodeMap::Node TimescaleMemory::decode_node(std::size_t index, const NodeMap::Node* old,
                                           const DecodeRules& rules, bool may_read) const {
  const MemoryNode& node = nodes_[index];
  NodeMap::Node result{node.position_m, node.observations, {}, false};
  const bool settled = is_settled(node, rules.unsettled_s);
  if (old != nullptr && old->is_pending) old = nullptr;
  const auto is_up_to_date = [&](std::size_t level) {
    if (old == nullptr) return false;
    if (!settled) return true;
    if (!node.is_evicted()) {
      return old->levels[level]->insertions == node.levels[level].insertions();
    }
    // Without a revision it has not been loaded since `old` was read from where it lies.
    return node.stored_revisions.empty() ||
           old->levels[level]->insertions == node.stored_revisions[level + 1];
  };
  const std::size_t levels = config_.levels.size();
  bool is_complete = true;
  for (std::size_t level = 0; level < levels; ++level) is_complete &= is_up_to_date(level);
  std::optional<MemoryNode> read;
  if (node.is_evicted() && !is_complete) {
    result.is_pending = !settled || (old == nullptr && !may_read);
    if (!result.is_pending) read = read_for(rules, index);
    result.is_pending = !read;
  }
  const std::vector<NodeLevel>& source = read ? read->levels : node.levels;
  for (std::size_t level = 0; level < levels; ++level) {
    if (is_up_to_date(level)) {
      result.levels.push_back(old->levels[level]);
    } else if (!settled || result.is_pending) {
      result.levels.push_back(rules.nothing);
    } else {
      result.levels.push_back(NodeMap::make_level(config_.bins(), config_.visibility.own_place_m,
                                                  source[level].insertions(),
                                                  memory::decode(source[level], rules.decoding)));
    }
  }
  return result;
}

std::shared_ptr<const NodeMap> TimescaleMemory::decode(const DecodingConfig& decoding,
                                                       const NodeMap* previous, double unsettled_s,
                                                       std::size_t max_loaded,
                                                       std::vector<DamagedNode>* damaged) const {
  const bool reusable = previous != nullptr && previous->decoding() == decoding;
  const std::vector<bool> may_read = to_read(reusable ? previous : nullptr, max_loaded);
  const DecodeRules rules{
      decoding, unsettled_s,
      NodeMap::make_level(config_.bins(), config_.visibility.own_place_m, 0,
                          memory::decode(NodeLevel(config_.bins(), 1, false), decoding)),
      damaged};
  std::vector<NodeMap::Node> nodes;
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    const NodeMap::Node* old =
        reusable && n < previous->nodes().size() ? &previous->nodes()[n] : nullptr;
    nodes.push_back(decode_node(n, old, rules, may_read[n]));
  }
  std::vector<std::string> names;
  for (const LevelConfig& level : config_.levels) names.push_back(level.name);
  return std::make_shared<const NodeMap>(config_.bins(), decoding, std::move(names),
                                         std::move(nodes), previous);
}

}  // namespace strata::memory
