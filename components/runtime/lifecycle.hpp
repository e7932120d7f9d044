// SPDX-License-Identifier: Apache-2.0
/// ROS 2's life of a managed node, as values: states, transitions, and which leads where. Numbers
/// and labels are those of lifecycle_msgs.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace strata::runtime {

enum class LifecycleState : std::uint8_t {
  kUnconfigured = 1,
  kInactive = 2,
  kActive = 3,
  kFinalized = 4
};

struct LifecycleTransition {
  std::uint8_t id;
  const char* label;
  LifecycleState start;
  LifecycleState goal;
};

inline constexpr std::array<LifecycleState, 4> kLifecycleStates = {
    LifecycleState::kUnconfigured, LifecycleState::kInactive, LifecycleState::kActive,
    LifecycleState::kFinalized};

inline constexpr std::array<LifecycleTransition, 7> kLifecycleTransitions = {{
    {1, "configure", LifecycleState::kUnconfigured, LifecycleState::kInactive},
    {2, "cleanup", LifecycleState::kInactive, LifecycleState::kUnconfigured},
    {3, "activate", LifecycleState::kInactive, LifecycleState::kActive},
    {4, "deactivate", LifecycleState::kActive, LifecycleState::kInactive},
    {5, "shutdown", LifecycleState::kUnconfigured, LifecycleState::kFinalized},
    {6, "shutdown", LifecycleState::kInactive, LifecycleState::kFinalized},
    {7, "shutdown", LifecycleState::kActive, LifecycleState::kFinalized},
}};

[[nodiscard]] constexpr const char* lifecycle_label(LifecycleState state) {
  switch (state) {
    case LifecycleState::kUnconfigured:
      return "unconfigured";
    case LifecycleState::kInactive:
      return "inactive";
    case LifecycleState::kActive:
      return "active";
    case LifecycleState::kFinalized:
      return "finalized";
  }
  return "unknown";
}

/// The transition out of `state` with that label or, when the label is empty, that id; nullptr when
/// there is none.
[[nodiscard]] constexpr const LifecycleTransition* find_transition(LifecycleState state,
                                                                   std::uint8_t id,
                                                                   std::string_view label = "") {
  for (const LifecycleTransition& transition : kLifecycleTransitions) {
    const bool is_meant = label.empty() ? transition.id == id : transition.label == label;
    if (transition.start == state && is_meant) return &transition;
  }
  return nullptr;
}

}  // namespace strata::runtime
