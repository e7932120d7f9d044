// SPDX-License-Identifier: Apache-2.0
#include "memory/nodes/node_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/error.hpp"

namespace strata::memory {
namespace {

constexpr double kLookupCell_m = 0.25;
constexpr float kUnknownRange = std::numeric_limits<float>::quiet_NaN();

}  // namespace

NodeMap::NodeMap(const PolarBins& bins, double reach_m, const DecodingConfig& decoding,
                 std::vector<std::string> level_names, std::vector<Node> nodes)
    : bins_(bins),
      reach_m_(reach_m),
      decoding_(decoding),
      level_names_(std::move(level_names)),
      nodes_(std::move(nodes)) {
  build_lookup();
}

std::shared_ptr<const NodeMap::Level> NodeMap::make_level(const PolarBins& bins, double own_place_m,
                                                          std::uint64_t insertions,
                                                          DecodedScan scan) {
  NodeOutline outline(bins, own_place_m, scan.range_m);
  return std::make_shared<const Level>(Level{insertions, std::move(scan), std::move(outline)});
}

void NodeMap::build_lookup() {
  CellRect all;
  const int reach = static_cast<int>(std::ceil(reach_m_ / kLookupCell_m)) + 1;
  auto around = [&](const Node& node) {
    const Cell cell = cell_at(node.position_m, kLookupCell_m);
    return CellRect{cell, {cell.x + 1, cell.y + 1}}.inflated(reach);
  };
  for (const Node& node : nodes_) all = all.united(around(node));
  Grid<double> nearest_m(kLookupCell_m, all);
  for (std::size_t l = 0; l < level_names_.size(); ++l) {
    Grid<std::int32_t>& lookup = lookup_.emplace_back(kLookupCell_m, all, -1);
    std::fill(nearest_m.values().begin(), nearest_m.values().end(), reach_m_);
    for (std::size_t n = 0; n < nodes_.size(); ++n) {
      if (nodes_[n].levels[l]->insertions == 0) continue;
      const CellRect rect = around(nodes_[n]);
      for (int y = rect.min.y; y < rect.max.y; ++y) {
        for (int x = rect.min.x; x < rect.max.x; ++x) {
          const Eigen::Vector2d offset = lookup.center({x, y}) - nodes_[n].position_m;
          const double distance_m = offset.norm();
          if (distance_m >= nearest_m.at({x, y})) continue;
          if (!nodes_[n].levels[l]->outline.contains(offset)) continue;
          nearest_m.at({x, y}) = distance_m;
          lookup.at({x, y}) = static_cast<std::int32_t>(n);
        }
      }
    }
  }
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

int NodeMap::node_at(int level, const Eigen::Vector2d& point_m) const {
  return lookup_[static_cast<std::size_t>(level)].get(cell_at(point_m, kLookupCell_m));
}

Scan NodeMap::expected_scan(int level, int node) const {
  Scan scan;
  scan.angle_min_rad = static_cast<float>(bins_.center_bearing_rad(0));
  scan.angle_increment_rad = static_cast<float>(bins_.angle_bin_rad());
  scan.range_max_m = static_cast<float>(bins_.max_range_m);
  scan.ranges_m = this->level(level, node).scan.range_m;
  return scan;
}

float NodeMap::expected_range_m(int level, const Pose2& map_from_laser, double bearing_rad) const {
  const Eigen::Vector2d laser_m = map_from_laser.translation();
  const int node = node_at(level, laser_m);
  if (node < 0) return kUnknownRange;
  const double angle = map_from_laser.theta + bearing_rad;
  const Eigen::Vector2d from = laser_m - nodes_[static_cast<std::size_t>(node)].position_m;
  return this->level(level, node).outline.cast(from, {std::cos(angle), std::sin(angle)});
}

void NodeMap::expected_ranges_m(int level, const Pose2& map_from_laser,
                                std::span<const double> bearings_rad,
                                std::span<float> ranges_m) const {
  for (std::size_t i = 0; i < ranges_m.size(); ++i) {
    ranges_m[i] = expected_range_m(level, map_from_laser, bearings_rad[i]);
  }
}

void NodeMap::expected_ranges_m(int level, const Pose2& map_from_laser,
                                std::span<const Eigen::Vector2d> directions,
                                std::span<float> ranges_m) const {
  const Eigen::Vector2d laser_m = map_from_laser.translation();
  const int node = node_at(level, laser_m);
  if (node < 0) {
    std::fill(ranges_m.begin(), ranges_m.end(), kUnknownRange);
    return;
  }
  const NodeOutline& outline = this->level(level, node).outline;
  const NodeOutline::Viewpoint view =
      outline.view_from(laser_m - nodes_[static_cast<std::size_t>(node)].position_m);
  const double c = std::cos(map_from_laser.theta);
  const double s = std::sin(map_from_laser.theta);
  for (std::size_t i = 0; i < ranges_m.size(); ++i) {
    const Eigen::Vector2d& d = directions[i];
    ranges_m[i] = outline.cast(view, {c * d.x() - s * d.y(), s * d.x() + c * d.y()});
  }
}

std::size_t NodeMap::bytes() const {
  std::size_t total = 0;
  for (const Node& node : nodes_) {
    for (const auto& level : node.levels) {
      total += level->outline.bytes() + level->scan.range_m.size() * sizeof(float);
    }
  }
  for (const auto& lookup : lookup_) total += lookup.size() * sizeof(std::int32_t);
  return total;
}

}  // namespace strata::memory
