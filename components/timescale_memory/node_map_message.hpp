// SPDX-License-Identifier: Apache-2.0
/// The node map on its latched topic.
#pragma once

#include <string>

#include "strata_idl/strata_msgs.h"

#include "core/base/time.hpp"
#include "memory/nodes/timescale_memory.hpp"

namespace strata::timescale_memory {

/// What every level of every node expects.
[[nodiscard]] strata_msgs::msg::NodeMap to_message(const memory::TimescaleMemory& memory,
                                                   const memory::NodeMap& map, Stamp stamp,
                                                   const std::string& frame);

}  // namespace strata::timescale_memory
