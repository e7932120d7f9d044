// SPDX-License-Identifier: Apache-2.0
#include "tools/doctor/topic_use.hpp"

#include <algorithm>
#include <array>

namespace strata::doctor {
namespace {

std::string_view last_part(std::string_view name) { return name.substr(name.rfind('/') + 1); }

template <std::size_t N>
bool is_one_of(std::string_view name, const std::array<std::string_view, N>& names) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

bool is_plumbing(std::string_view wire_name) {
  constexpr std::array<std::string_view, 3> kOfEveryNode{"parameter_events", "rosout",
                                                         "transition_event"};
  if (wire_name.find("/_action/") != std::string_view::npos) return true;
  if (!wire_name.starts_with("rt/")) {
    return wire_name.starts_with("rq/") || wire_name.starts_with("rr/") ||
           wire_name == "ros_discovery_info";
  }
  return is_one_of(last_part(wire_name), kOfEveryNode);
}

bool is_occasional(std::string_view name) {
  constexpr std::array<std::string_view, 10> kByPeople{
      "initialpose",    "initial_pose", "goal_pose",   "goal",     "clicked_point",
      "cmd_vel_teleop", "bond",         "speed_limit", "landmark", "given_pose"};
  return is_one_of(last_part(name), kByPeople);
}

}  // namespace strata::doctor
