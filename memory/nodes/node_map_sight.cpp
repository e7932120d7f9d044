// SPDX-License-Identifier: Apache-2.0
/// What is seen from a place: the nodes around it, and how far beams go in their sight.
#include <algorithm>
#include <cmath>
#include <limits>

#include "memory/nodes/node_map.hpp"

namespace strata::memory {
namespace {

/// Nodes that see one surface differ by no more than this about it.
constexpr double kAgreement_m = 0.3;
/// A beam that leaves a node's sight goes on from this far behind, at most so many times.
constexpr double kStepOut_m = 0.1;
constexpr int kMaxHops = 3;

using Reach = NodeOutline::Reach;
using Edge = NodeOutline::Edge;

float range_of(const Reach& reach) {
  switch (reach.end) {
    case Edge::kSurface:
      return static_cast<float>(reach.range_m);
    case Edge::kOpen:
      return std::numeric_limits<float>::infinity();
    default:
      return std::numeric_limits<float>::quiet_NaN();
  }
}

}  // namespace

NodeMap::View NodeMap::view(int level, const Eigen::Vector2d& point_m) const {
  View result;
  result.place_m_ = point_m;
  result.level_ = level;
  const Cell cell = lookup_->cell_at(point_m);
  if (!lookup_->contains(cell)) return result;
  // The cell's list is in order of the distance from its centre; the place may be elsewhere in it.
  struct Candidate {
    double distance_squared;
    std::int32_t node;
  };
  std::array<Candidate, kMaxAround> candidates;
  std::size_t count = 0;
  for (const std::int32_t node : lookup_->at(cell)) {
    if (node < 0) break;
    const Eigen::Vector2d& position_m = nodes_[static_cast<std::size_t>(node)].position_m;
    std::size_t place = count++;
    const double distance_squared = (point_m - position_m).squaredNorm();
    for (; place > 0 && candidates[place - 1].distance_squared > distance_squared; --place) {
      candidates[place] = candidates[place - 1];
    }
    candidates[place] = {distance_squared, node};
  }
  for (std::size_t i = 0; i < count && result.size_ < View::kMax; ++i) {
    const std::int32_t node = candidates[i].node;
    const Level& decoded = this->level(level, node);
    if (decoded.insertions == 0) continue;
    const NodeOutline::Viewpoint from =
        decoded.outline.view_from(point_m - nodes_[static_cast<std::size_t>(node)].position_m);
    if (!from.inside) continue;
    result.seen_[result.size_++] = {node, &decoded.outline, from};
  }
  return result;
}

template <std::size_t kMax>
void NodeMap::reach_in_sight(const View& view, std::span<const Eigen::Vector2d> directions,
                             std::span<Reach> reach) {
  std::fill(reach.begin(), reach.end(), Reach());
  // The beams whose end no node has seen yet.
  std::array<std::uint8_t, kMax> open;
  static_assert(kMax <= 256);
  std::array<Eigen::Vector2d, kMax> asked;
  std::array<Reach, kMax> found;
  std::size_t count = directions.size();
  for (std::size_t k = 0; k < count; ++k) open[k] = static_cast<std::uint8_t>(k);
  for (std::size_t i = 0; i < view.size_ && count > 0; ++i) {
    for (std::size_t k = 0; k < count; ++k) asked[k] = directions[open[k]];
    view.seen_[i].outline->cast(view.seen_[i].from, std::span(asked.data(), count),
                                std::span(found.data(), count));
    std::size_t still_open = 0;
    for (std::size_t k = 0; k < count; ++k) {
      Reach& best = reach[open[k]];
      const Reach& next = found[k];
      const bool is_taken =
          next.end != Edge::kUnseen && next.range_m >= best.range_m - kAgreement_m;
      const bool ends = is_taken && next.end == Edge::kSurface;
      if (ends || (is_taken && (next.range_m > best.range_m || best.end == Edge::kUnseen))) {
        best = next;
      }
      open[still_open] = open[k];
      still_open += ends ? 0 : 1;
    }
    count = still_open;
  }
}

NodeOutline::Reach NodeMap::reach(const View& view, const Eigen::Vector2d& direction) const {
  Reach reach;
  reach_in_sight<1>(view, std::span(&direction, 1), std::span(&reach, 1));
  go_on(view, direction, reach);
  return reach;
}

void NodeMap::reach(const View& view, std::span<const Eigen::Vector2d> directions,
                    std::span<Reach> reach) const {
  for (std::size_t begin = 0; begin < directions.size(); begin += kMaxAtOnce) {
    const std::size_t count = std::min(kMaxAtOnce, directions.size() - begin);
    reach_in_sight<kMaxAtOnce>(view, directions.subspan(begin, count), reach.subspan(begin, count));
  }
  for (std::size_t i = 0; i < directions.size(); ++i) go_on(view, directions[i], reach[i]);
}

void NodeMap::go_on(const View& view, const Eigen::Vector2d& direction, Reach& reach) const {
  for (int hop = 0; hop < kMaxHops; ++hop) {
    const bool ends = reach.end == Edge::kSurface || reach.end == Edge::kUnseen;
    const double left_m = reach.range_m + kStepOut_m;
    if (ends || left_m >= bins_.max_range_m) break;
    const View there = this->view(view.level_, view.place_m_ + left_m * direction);
    Reach next;
    reach_in_sight<1>(there, std::span(&direction, 1), std::span(&next, 1));
    if (next.end == Edge::kUnseen) break;
    reach = {left_m + next.range_m, next.end};
  }
}

int NodeMap::node_at(int level, const Eigen::Vector2d& point_m) const {
  const View seen = view(level, point_m);
  return seen.empty() ? -1 : seen.node();
}

Scan NodeMap::expected_scan(int level, int node) const {
  Scan scan;
  scan.angle_min_rad = static_cast<float>(bins_.center_bearing_rad(0));
  scan.angle_increment_rad = static_cast<float>(bins_.angle_bin_rad());
  scan.range_max_m = static_cast<float>(bins_.max_range_m);
  scan.ranges_m = this->level(level, node).scan.range_m;
  std::replace_if(
      scan.ranges_m.begin(), scan.ranges_m.end(), [](float range_m) { return range_m < 0.0F; },
      std::numeric_limits<float>::quiet_NaN());
  return scan;
}

float NodeMap::expected_range_m(int level, const Pose2& map_from_laser, double bearing_rad) const {
  float range_m = 0.0F;
  expected_ranges_m(level, map_from_laser, std::span(&bearing_rad, 1), std::span(&range_m, 1));
  return range_m;
}

void NodeMap::expected_ranges_m(int level, const Pose2& map_from_laser,
                                std::span<const double> bearings_rad,
                                std::span<float> ranges_m) const {
  const View from = view(level, map_from_laser.translation());
  std::array<Eigen::Vector2d, kMaxAtOnce> directions;
  std::array<Reach, kMaxAtOnce> found;
  for (std::size_t begin = 0; begin < ranges_m.size(); begin += kMaxAtOnce) {
    const std::size_t count = std::min(kMaxAtOnce, ranges_m.size() - begin);
    for (std::size_t k = 0; k < count; ++k) {
      const double angle = map_from_laser.theta + bearings_rad[begin + k];
      directions[k] = {std::cos(angle), std::sin(angle)};
    }
    reach(from, std::span(directions.data(), count), std::span(found.data(), count));
    for (std::size_t k = 0; k < count; ++k) ranges_m[begin + k] = range_of(found[k]);
  }
}
}  // namespace strata::memory
