// SPDX-License-Identifier: Apache-2.0
#include "memory/nodes/node_map.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/error.hpp"

namespace strata::memory {
namespace {

constexpr double kLookupCell_m = 0.5;
/// Snapshots after which the look-up table is made anew.
constexpr int kOldestLookup = 100;

bool is_filled(const std::vector<std::shared_ptr<const NodeMap::Level>>& levels) {
  return std::any_of(levels.begin(), levels.end(),
                     [](const auto& level) { return level->insertions > 0; });
}

/// Requires that `to` covers `from`.
template <typename T>
void copy_into(const Grid<T>& from, Grid<T>& to) {
  for (std::size_t i = 0; i < from.size(); ++i) to.at(from.cell(i)) = from.values()[i];
}

}  // namespace

NodeMap::NodeMap(const PolarBins& bins, const DecodingConfig& decoding,
                 std::vector<std::string> level_names, std::vector<Node> nodes,
                 const NodeMap* previous)
    : bins_(bins),
      decoding_(decoding),
      level_names_(std::move(level_names)),
      nodes_(std::move(nodes)) {
  if (previous == nullptr || !may_keep_lookup(*previous)) {
    lookup_ = std::make_shared<const Grid<Around>>(make_lookup());
    return;
  }
  lookup_age_ = previous->lookup_age_ + 1;
  const std::vector<std::int32_t> newly_filled = filled_since(*previous);
  if (newly_filled.empty()) {
    lookup_ = previous->lookup_;
  } else {
    Grid<Around> lookup = empty_lookup();
    copy_into(*previous->lookup_, lookup);
    for (const std::int32_t node : newly_filled) enter(node, lookup);
    lookup_ = std::make_shared<const Grid<Around>>(std::move(lookup));
  }
}

bool NodeMap::may_keep_lookup(const NodeMap& other) const {
  return other.lookup_age_ < kOldestLookup && other.bins_ == bins_ &&
         other.nodes_.size() <= nodes_.size() &&
         std::equal(other.nodes_.begin(), other.nodes_.end(), nodes_.begin(),
                    [](const Node& old, const Node& now) {
                      return old.position_m == now.position_m &&
                             (is_filled(now.levels) || !is_filled(old.levels));
                    });
}

std::vector<std::int32_t> NodeMap::filled_since(const NodeMap& other) const {
  std::vector<std::int32_t> result;
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    const bool was_filled = n < other.nodes_.size() && is_filled(other.nodes_[n].levels);
    if (!was_filled && is_filled(nodes_[n].levels)) result.push_back(static_cast<std::int32_t>(n));
  }
  return result;
}

std::shared_ptr<const NodeMap::Level> NodeMap::make_level(const PolarBins& bins, double own_place_m,
                                                          std::uint64_t insertions,
                                                          DecodedScan scan) {
  NodeOutline outline(bins, own_place_m, scan.range_m);
  return std::make_shared<const Level>(Level{insertions, std::move(scan), std::move(outline)});
}

bool NodeMap::sees(const Node& node, const Eigen::Vector2d& center_m) const {
  constexpr double kHalf_m = 0.5 * kLookupCell_m;
  const Eigen::Vector2d offset = center_m - node.position_m;
  for (const auto& level : node.levels) {
    if (level->insertions == 0) continue;
    for (const Eigen::Vector2d& aside :
         {Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(-kHalf_m, -kHalf_m),
          Eigen::Vector2d(kHalf_m, -kHalf_m), Eigen::Vector2d(-kHalf_m, kHalf_m),
          Eigen::Vector2d(kHalf_m, kHalf_m)}) {
      if (level->outline.contains(offset + aside)) return true;
    }
  }
  return false;
}

void NodeMap::enter(std::int32_t node, Grid<Around>& lookup) const {
  const Node& own = nodes_[static_cast<std::size_t>(node)];
  const int reach = static_cast<int>(std::ceil(bins_.max_range_m / kLookupCell_m));
  const Cell middle = cell_at(own.position_m, kLookupCell_m);
  for (int y = middle.y - reach; y <= middle.y + reach; ++y) {
    for (int x = middle.x - reach; x <= middle.x + reach; ++x) {
      const Eigen::Vector2d center = lookup.center({x, y});
      auto distance_squared = [&](std::int32_t other) {
        return (nodes_[static_cast<std::size_t>(other)].position_m - center).squaredNorm();
      };
      Around& list = lookup.at({x, y});
      const double distance = distance_squared(node);
      std::size_t place = kMaxAround;
      while (place > 0 && (list[place - 1] < 0 || distance_squared(list[place - 1]) > distance)) {
        --place;
      }
      if (place == kMaxAround || !sees(own, center)) continue;
      std::move_backward(list.begin() + static_cast<std::ptrdiff_t>(place), list.end() - 1,
                         list.end());
      list[place] = node;
    }
  }
}

Grid<NodeMap::Around> NodeMap::make_lookup() const {
  Grid<Around> lookup = empty_lookup();
  for (std::size_t n = 0; n < nodes_.size(); ++n) enter(static_cast<std::int32_t>(n), lookup);
  return lookup;
}

Grid<NodeMap::Around> NodeMap::empty_lookup() const {
  Around nobody;
  nobody.fill(-1);
  CellRect all;
  const int reach = static_cast<int>(std::ceil(bins_.max_range_m / kLookupCell_m));
  for (const Node& node : nodes_) {
    const Cell cell = cell_at(node.position_m, kLookupCell_m);
    all = all.united(CellRect{cell, {cell.x + 1, cell.y + 1}}.inflated(reach));
  }
  return Grid<Around>(kLookupCell_m, all, nobody);
}

int NodeMap::level_index(const std::string& name) const {
  std::string known;
  for (std::size_t l = 0; l < level_names_.size(); ++l) {
    if (level_names_[l] == name) return static_cast<int>(l);
    known += (known.empty() ? "" : ", ") + level_names_[l];
  }
  throw ConfigError("timescale level '" + name + "'", "is not in the memory",
                    "choose one of: " + known);
}

std::size_t NodeMap::bytes() const {
  std::size_t total = 0;
  for (const Node& node : nodes_) {
    for (const auto& level : node.levels) {
      total += level->outline.bytes() + level->scan.range_m.size() * sizeof(float);
    }
  }
  return total + lookup_->size() * sizeof(Around);
}

}  // namespace strata::memory
