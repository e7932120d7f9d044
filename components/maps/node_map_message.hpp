// SPDX-License-Identifier: Apache-2.0
/// The node map on its latched topic.
#pragma once

#include <memory>
#include <string>

#include "strata_idl/strata_msgs.h"

#include "core/base/time.hpp"
#include "memory/nodes/timescale_memory.hpp"

namespace strata::maps {

/// What every level of every node expects; nodes that are pending are left out.
[[nodiscard]] strata_msgs::msg::NodeMap to_message(const memory::TimescaleMemory& memory,
                                                   const memory::NodeMap& map, Stamp stamp,
                                                   const std::string& frame);

/// What the message does not say of the memory it came from.
struct NodeMapShape {
  double own_place_m = memory::TimescaleConfig{}.visibility.own_place_m;
};
/// The same expectations again, bit for bit when the shape is the memory's own. previous: the map
/// of an earlier message, whose look-up table may be shared, or null. Throws InputError when nodes
/// differ in their levels or bins, or lie or see so far that a table of their surroundings would
/// take all memory: more than 4 km^2 in all, or 40 km^2 counted node by node.
[[nodiscard]] std::shared_ptr<const memory::NodeMap> from_message(
    const strata_msgs::msg::NodeMap& message, const NodeMapShape& shape,
    const memory::NodeMap* previous = nullptr);

}  // namespace strata::maps
