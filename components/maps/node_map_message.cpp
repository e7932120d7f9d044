// SPDX-License-Identifier: Apache-2.0
#include "components/maps/node_map_message.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "components/convert/geometry_messages.hpp"
#include "core/base/error.hpp"

namespace strata::maps {
namespace {

// What a table over the surroundings of all nodes can hold: a damaged number must not make it take
// all memory, nor time without end.
constexpr double kFarthest_m = 1e5;    // of a node
constexpr double kMaxArea_m2 = 4e6;    // of the rectangle about what all nodes see
constexpr double kMaxSights_m2 = 4e7;  // of what each node sees, one by one

bool fits_a_table(const strata_msgs::msg::NodeMap& message) {
  Eigen::AlignedBox2d all;
  for (const auto& node : message.nodes()) {
    const Eigen::Vector2d position_m(node.pose().x(), node.pose().y());
    if (!(position_m.array().abs() <= kFarthest_m).all()) return false;  // nor NaN
    all.extend(position_m);
  }
  const double sight_m = 2.0 * message.radius();
  if (!(sight_m > 0.0 && sight_m <= kFarthest_m)) return false;
  if (all.isEmpty()) return true;
  const auto nodes = static_cast<double>(message.nodes().size());
  return (all.sizes().array() + sight_m).prod() <= kMaxArea_m2 &&
         nodes * sight_m * sight_m <= kMaxSights_m2;
}

}  // namespace

strata_msgs::msg::NodeMap to_message(const memory::TimescaleMemory& memory,
                                     const memory::NodeMap& map, Stamp stamp,
                                     const std::string& frame) {
  strata_msgs::msg::NodeMap message;
  message.header(convert::make_header(stamp, frame));
  message.radius(map.bins().max_range_m);
  for (std::size_t i = 0; i < map.nodes().size(); ++i) {
    const auto& node = map.nodes()[i];
    if (node.is_pending) continue;
    strata_msgs::msg::MemoryNode entry;
    entry.id(static_cast<std::int32_t>(i));
    entry.pose(convert::to_message(Pose2{node.position_m.x(), node.position_m.y(), 0.0}));
    entry.observations(node.observations);
    for (std::size_t level = 0; level < node.levels.size(); ++level) {
      strata_msgs::msg::NodeLevel expected;
      expected.name(map.level_names()[level]);
      expected.half_life_s(memory.config().levels[level].nominal_half_life_s());
      expected.consistent(!node.levels[level]->scan.inconsistent);
      expected.ranges(node.levels[level]->scan.range_m);
      entry.levels().push_back(std::move(expected));
    }
    message.nodes().push_back(std::move(entry));
  }
  return message;
}

std::shared_ptr<const memory::NodeMap> from_message(const strata_msgs::msg::NodeMap& message,
                                                    const NodeMapShape& shape,
                                                    const memory::NodeMap* previous) {
  const auto refuse = [] {
    throw InputError("NodeMap", "its nodes differ in their levels or bins",
                     "check the sender's version");
  };
  if (!fits_a_table(message)) {
    throw InputError("NodeMap", "its nodes lie too far from each other, or see too far",
                     "check the sender's max_range_m, and that its map is sound");
  }
  memory::PolarBins bins;
  bins.max_range_m = message.radius();
  std::vector<std::string> names;
  if (!message.nodes().empty()) {
    for (const auto& level : message.nodes().front().levels()) names.push_back(level.name());
    if (!names.empty()) {
      bins.angle_bins = static_cast<int>(message.nodes().front().levels()[0].ranges().size());
    }
  }
  std::vector<memory::NodeMap::Node> nodes;
  for (const auto& entry : message.nodes()) {
    const Pose2 pose = convert::from_message(entry.pose());
    memory::NodeMap::Node node{{pose.x, pose.y}, entry.observations(), {}};
    if (entry.levels().size() != names.size()) refuse();
    for (const auto& level : entry.levels()) {
      const std::vector<float>& ranges = level.ranges();
      if (static_cast<int>(ranges.size()) != bins.angle_bins || ranges.empty()) refuse();
      if (std::any_of(ranges.begin(), ranges.end(), [&](float range) {
            return static_cast<double>(range) < -bins.max_range_m;
          })) {
        throw InputError("NodeMap", "a way is free for longer than its nodes see",
                         "check the sender's version");
      }
      // A level that nothing was put into expects nothing anywhere.
      const bool is_known =
          std::any_of(ranges.begin(), ranges.end(), [](float range) { return !std::isnan(range); });
      node.levels.push_back(memory::NodeMap::make_level(bins, shape.own_place_m, is_known ? 1 : 0,
                                                        {ranges, 0.0, !level.consistent()}));
    }
    nodes.push_back(std::move(node));
  }
  return std::make_shared<const memory::NodeMap>(bins, memory::DecodingConfig{}, std::move(names),
                                                 std::move(nodes), previous);
}

}  // namespace strata::maps
