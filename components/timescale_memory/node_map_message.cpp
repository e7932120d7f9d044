// SPDX-License-Identifier: Apache-2.0
#include "components/timescale_memory/node_map_message.hpp"

#include "components/convert/geometry_messages.hpp"

namespace strata::timescale_memory {

strata_msgs::msg::NodeMap to_message(const memory::TimescaleMemory& memory,
                                     const memory::NodeMap& map, Stamp stamp,
                                     const std::string& frame) {
  strata_msgs::msg::NodeMap message;
  message.header(convert::make_header(stamp, frame));
  message.radius(map.bins().max_range_m);
  for (std::size_t i = 0; i < map.nodes().size(); ++i) {
    const auto& node = map.nodes()[i];
    strata_msgs::msg::MemoryNode entry;
    entry.id(static_cast<std::int32_t>(i));
    entry.pose(convert::to_message(Pose2{node.position_m.x(), node.position_m.y(), 0.0}));
    entry.observations(node.observations);
    for (std::size_t level = 0; level < node.levels.size(); ++level) {
      strata_msgs::msg::NodeLevel expected;
      expected.name(map.level_names()[level]);
      expected.half_life_s(memory.config().levels[level].nominal_half_life_s());
      expected.consistent(!node.levels[level]->scan.inconsistent);
      expected.ranges(map.expected_scan(static_cast<int>(level), static_cast<int>(i)).ranges_m);
      entry.levels().push_back(std::move(expected));
    }
    message.nodes().push_back(std::move(entry));
  }
  return message;
}

}  // namespace strata::timescale_memory
