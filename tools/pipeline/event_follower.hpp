// SPDX-License-Identifier: Apache-2.0
/// How soon and how wholly a prediction follows a change (docs/theory/evaluation.md, "Changes").
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "components/maps/map_model.hpp"
#include "core/localization/patch_states.hpp"
#include "core/patch/patch_map.hpp"
#include "core/scan/scan.hpp"
#include "tools/pipeline/changes.hpp"

namespace strata::pipeline {

/// What became of one change.
struct EventOutcome {
  /// Scans that show the change before the first one from which on at least 90% of the changed bins
  /// are predicted within kBinTolerance_m, over five such scans together; 0: from the first on.
  /// Nothing: not in this visit.
  std::optional<double> adapted_after_scans;
  std::optional<double> adapted_after_s;
  /// Held-out fit per beam over the first ten scans that show the change, less that of the map as
  /// it was then; for old states only.
  std::optional<double> recall;
  /// belief_in_state() after those scans; for patch models whose sub-maps cover the change.
  std::optional<double> true_state_probability;
  /// Share of the scans that show the change in which what changed was expected half as before and
  /// half as it is now: at least a quarter of the beams each.
  double mixed_share = 0.0;
};

/// Scans, poses and changes of the test part; equal lengths.
struct TestScans {
  std::span<const Observation> observations;
  std::span<const std::optional<Pose2>> truths;  ///< map_from_robot; scans without are left out
  const Changes* changes = nullptr;              ///< null: nothing is known of changes
};

/// The probability that a place is as the event found it: of the sub-map that shows it best, the
/// configurations that agree with at least 80% of the changed cells, together (a box beside a door
/// says nothing of the door). Nothing where no sub-map holds half of the changed cells and has such
/// a configuration. beliefs must hold one a sub-map. O(changed cells x configurations).
[[nodiscard]] std::optional<double> belief_in_state(
    const ChangeEvent& event, const patch::PatchMap& map,
    std::span<const localization::SubmapBelief> beliefs);

/// Which change a scan shows, and what came of it. O(changed bins) a scan.
class EventFollower {
 public:
  /// limit_m: longer ranges count as this one; 0: only the scan's own limit. `test` must stay.
  EventFollower(const TestScans& test, double limit_m);

  /// (event, view) pairs of a scan.
  [[nodiscard]] const std::vector<std::pair<std::size_t, std::size_t>>& views_of(
      std::size_t scan) const {
    return views_[scan];
  }
  /// Keeps how much of the change the prediction made before the scan has right. The scan's truth
  /// must be known.
  void see(std::size_t scan, const maps::RangeFunction& expected_range);
  [[nodiscard]] EventOutcome& outcome(std::size_t event) { return outcomes_[event]; }
  /// The outcomes, adaptation and mixed scans included; once.
  [[nodiscard]] std::vector<EventOutcome> take();

 private:
  /// Of the changed bins of a view: how many are expected as they are now, and as they were before.
  struct ViewCounts {
    std::size_t as_now = 0;
    std::size_t as_before = 0;
  };

  [[nodiscard]] ViewCounts count_predicted(std::size_t scan, const ChangeView& view,
                                           const maps::RangeFunction& expected_range) const;
  void judge_adaptation(std::size_t e);
  void judge_consistency(std::size_t e);
  [[nodiscard]] double limit_of(const Scan& scan) const;

  const TestScans& test_;
  double limit_m_;
  std::vector<EventOutcome> outcomes_;
  std::vector<std::vector<std::pair<std::size_t, std::size_t>>> views_;
  std::vector<std::vector<ViewCounts>> predicted_;  ///< per event and view
};

}  // namespace strata::pipeline
