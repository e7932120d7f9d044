// SPDX-License-Identifier: Apache-2.0
/// What changed in the world between the scans that maps were learned from and those they are
/// tested on, told from the scans themselves at the true poses: no map model has a say in it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/grid/grid.hpp"
#include "core/grid/reflection_grid.hpp"
#include "core/patch/patch_learner.hpp"
#include "core/rays/ray_caster.hpp"
#include "core/rays/scan_beams.hpp"
#include "core/scan/scan.hpp"

namespace strata::pipeline {

/// The beams of one test scan that can tell a change: what a beam would measure before and after it
/// differs by more than the tolerance, and the beam measured what it should after it, so that no
/// one stands in the way: "changed bins" (docs/theory/evaluation.md, "Changes").
struct ChangeView {
  std::size_t scan = 0;  ///< of the test part
  std::vector<std::uint32_t> beams;
  std::vector<float> before_m;  ///< what each of them would have measured before the change
};

/// The robot came by and found a place in another state than it was last seen in.
struct ChangeEvent {
  Eigen::Vector2d center_m;  ///< of the changed cells, map frame
  std::size_t cells = 0;
  double appeared_share = 0.0;  ///< of the changed cells, those that are occupied now
  /// An earlier visit found the changed cells as they are now: an old state came back. Otherwise it
  /// was never seen before.
  bool is_old_state = false;
  std::vector<ChangeView> views;       ///< of this visit, in order; at least one
  std::vector<Cell> changed;           ///< the cells ...
  std::vector<std::uint8_t> occupied;  ///< ... and whether each is occupied now
  /// The map as it is now: what the best possible map would predict.
  std::shared_ptr<const rays::RayCaster> oracle;
};

struct Changes {
  Grid<std::uint8_t> places;        ///< 1: visits contradict each other here
  std::vector<ChangeEvent> events;  ///< in the order in which the robot met them
  /// Per test scan: the beams that reach a place that changed. Empty for most scans.
  std::vector<std::vector<std::uint32_t>> place_beams;

  /// Whether enough beams of the scan reach a changed place for it to count as "where it changed".
  [[nodiscard]] bool sees_change(std::size_t scan) const;
};

/// A scan tells of a change from this many beams on.
inline constexpr std::size_t kMinChangedBeams = 3;
/// A bin is predicted when the prediction is this close to the measurement: a smaller difference
/// may be noise and pose error (docs/theory/evaluation.md, "Changes").
inline constexpr double kBinTolerance_m = 0.15;

/// Finds places by the contradiction test of patch maps over all visits, learned and tested
/// together, and over those about the split; then goes through the visits of each place in time:
/// cells known in another state than before are a change when there are at least four of them. Only
/// visits that begin in the test part make events. learned: scans at the poses that the maps were
/// learned with. truths: of the test scans; those without are left out. base: the static map that
/// stands wherever no place is. r_max_m: beams count as no return from there on; 0: the scan's own
/// limit. Changes in view of the robot fall within one visit and are not found. O(beams x cells a
/// beam crosses).
[[nodiscard]] Changes find_changes(std::span<const PosedScan> learned,
                                   std::span<const Observation> tested,
                                   std::span<const std::optional<Pose2>> truths,
                                   const ReflectionGrid& base,
                                   const patch::PatchLearnerConfig& config, double r_max_m);

}  // namespace strata::pipeline
