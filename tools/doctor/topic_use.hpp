// SPDX-License-Identifier: Apache-2.0
/// What topics are for, by the names that ROS 2 gives them.
#pragma once

#include <string>
#include <string_view>

namespace strata::doctor {

/// Services, actions' services, and what every node has: parameters, logs, transitions, the graph.
/// wire_name: as it is on the wire, "rt/scan", "rq/robot/get_stateRequest".
[[nodiscard]] bool is_plumbing(std::string_view wire_name);

/// What people or managers publish now and then, such as RViz's poses and goals: that nobody does
/// is no fault. name: "/robot1/initialpose".
[[nodiscard]] bool is_occasional(std::string_view name);

}  // namespace strata::doctor
