// SPDX-License-Identifier: Apache-2.0
/// The visits of many cells while beams come, each cell's as a list from the newest to the oldest.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <utility>
#include <vector>

#include "core/patch/visit_clock.hpp"
#include "core/patch/visits.hpp"

namespace strata::patch {

/// Lists are named by the place of their newest visit; -1: empty. A visit ends with a gap, or when
/// what it sees has changed for good: until that is sure the beams since the change are a visit on
/// trial, the newest of its list, which becomes part of the one before unless the state holds. A
/// visit before a change that was brief itself goes: who knows what stood there.
class VisitChains {
 public:
  /// One more beam of the scan that the clock has come to, at the cell of that list. True when the
  /// list has one visit more that is not on trial. O(1).
  bool add(std::int32_t& newest, const VisitClock& clock, std::uint32_t scan, bool is_hit,
           float amount, const BeamAxis& axis);
  /// Whether the newest visit, not on trial, began with a change in view. O(1).
  [[nodiscard]] bool follows_change(std::int32_t newest, const VisitClock& clock) const {
    const std::int32_t before = node(newest).previous;
    return before >= 0 && clock.is_settled(node(newest).visit) &&
           VisitClock::is_change(node(before).visit, node(newest).visit);
  }
  /// A visit on trial becomes part of the one before. O(1).
  void end_trial(std::int32_t& newest);
  /// Down to `most` visits that are not on trial: the oldest of the more frequent kind go, the
  /// newest stays. O(visits^2).
  void forget_surplus(std::int32_t newest, int most);
  /// Appends the visits in order of time, what is on trial as part of the one before. O(visits).
  void collect(std::int32_t newest, std::vector<Visit>& visits) const;
  /// Moves the lists together, so that what was forgotten is given back; none may be on trial.
  /// newest: of all of them. O(visits).
  template <class Lists>
  void pack(Lists& newest) {
    std::deque<Node> packed;
    for (std::int32_t& list : newest) {
      std::int32_t* link = &list;
      for (std::int32_t n = list; n >= 0;) {
        packed.push_back(node(n));
        *link = static_cast<std::int32_t>(packed.size()) - 1;
        n = packed.back().previous;
        link = &packed.back().previous;
      }
    }
    nodes_ = std::move(packed);
    leads_.assign(nodes_.size(), kNotOnTrial);
    free_ = -1;
  }

  /// Whether every list leads to visits of its own, and only the newest is on trial.
  template <class Lists>
  [[nodiscard]] bool is_sound(const Lists& newest) const {
    std::vector<bool> is_reached(nodes_.size(), false);
    if (leads_.size() != nodes_.size() || !reaches_new(free_, is_reached)) return false;
    for (const std::int32_t list : newest) {
      if (!reaches_new(list, is_reached)) return false;
    }
    return true;
  }

  [[nodiscard]] std::size_t bytes() const { return nodes_.size() * (sizeof(Node) + sizeof(float)); }

  /// For core/base/state_archive.hpp; without trials as before there were any.
  template <class Self, class Archive>
  static void state(Self& self, Archive& archive, bool has_trials) {
    archive(self.nodes_);
    archive(self.free_);
    if (has_trials) {
      archive(self.leads_);
    } else if constexpr (Archive::kReads) {
      self.leads_.assign(self.nodes_.size(), kNotOnTrial);
    }
  }

 private:
  struct Node {
    Visit visit;
    std::int32_t previous = -1;  ///< of the same cell; of a free node the next free one
  };
  static constexpr float kNotOnTrial = -1.0F;
  static constexpr float kBrief = -2.0F;  // the visit before one on trial, if it was brief

  [[nodiscard]] Node& node(std::int32_t i) { return nodes_[static_cast<std::size_t>(i)]; }
  [[nodiscard]] const Node& node(std::int32_t i) const {
    return nodes_[static_cast<std::size_t>(i)];
  }
  [[nodiscard]] float& lead(std::int32_t i) { return leads_[static_cast<std::size_t>(i)]; }
  [[nodiscard]] bool is_on_trial(std::int32_t i) const {
    return leads_[static_cast<std::size_t>(i)] >= 0.0F;
  }
  void begin(std::int32_t& newest, std::uint32_t scan, float lead);
  void free(std::int32_t i);
  /// Whether a visit on trial has become one of its own.
  bool judge(std::int32_t& newest, const VisitClock& clock, std::uint32_t scan);
  [[nodiscard]] bool reaches_new(std::int32_t list, std::vector<bool>& is_reached) const;

  std::deque<Node> nodes_;  // grows without a copy
  /// Of a visit on trial: its beams that speak for the new state less those against it.
  std::deque<float> leads_;
  std::int32_t free_ = -1;
};

}  // namespace strata::patch
