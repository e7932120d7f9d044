// SPDX-License-Identifier: Apache-2.0
/// ROS 2's life of a managed node, as values: states, transitions, and which leads where. Numbers
/// and labels are those of lifecycle_msgs.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace strata::runtime {

enum class LifecycleState : std::uint8_t {
  kUnconfigured = 1,
  kInactive = 2,
  kActive = 3,
  kFinalized = 4,
  // On the way: told to others, never a component's state().
  kConfiguring = 10,
  kCleaningUp = 11,
  kShuttingDown = 12,
  kActivating = 13,
  kDeactivating = 14
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

/// In the order of the transitions that lead into them.
inline constexpr std::array<LifecycleState, 5> kStatesOnTheWay = {
    LifecycleState::kConfiguring, LifecycleState::kCleaningUp, LifecycleState::kActivating,
    LifecycleState::kDeactivating, LifecycleState::kShuttingDown};

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
    case LifecycleState::kConfiguring:
      return "configuring";
    case LifecycleState::kCleaningUp:
      return "cleaningup";
    case LifecycleState::kShuttingDown:
      return "shuttingdown";
    case LifecycleState::kActivating:
      return "activating";
    case LifecycleState::kDeactivating:
      return "deactivating";
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

/// ROS 2 tells each transition in two steps: into the state on the way, and out of it. The first.
[[nodiscard]] constexpr LifecycleTransition first_step(const LifecycleTransition& transition) {
  const std::size_t place = transition.id < 5U ? transition.id - 1U : 4U;  // three are shutdowns
  return {transition.id, transition.label, transition.start, kStatesOnTheWay.at(place)};
}

/// The second: to the goal or, after a failure, back to where it started.
[[nodiscard]] constexpr LifecycleTransition second_step(const LifecycleTransition& transition,
                                                        bool succeeds) {
  const unsigned kind = transition.id < 5U ? transition.id : 5U;
  const unsigned id = 10U * kind + (succeeds ? 0U : 1U);
  return {static_cast<std::uint8_t>(id), succeeds ? "transition_success" : "transition_failure",
          first_step(transition).goal, succeeds ? transition.goal : transition.start};
}

}  // namespace strata::runtime
