// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/event_follower.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/scan/range_limit.hpp"

namespace strata::pipeline {
namespace {
constexpr double kAdaptedShare = 0.9;
constexpr std::size_t kAdaptedWindow = 5;
/// Half old, half new: each at least this share of the beams.
constexpr double kMixedShare = 0.25;
/// A configuration that agrees with fewer of the changed cells is another state.
constexpr double kSameConfiguration = 0.8;

/// The share of the changed cells in the sub-map that the configuration shows as they are; nothing
/// where the sub-map holds less than half of them.
std::optional<double> agreement(const ChangeEvent& event, const patch::Submap& submap,
                                const patch::Configuration& configuration) {
  std::size_t inside = 0;
  std::size_t same = 0;
  for (std::size_t c = 0; c < event.changed.size(); ++c) {
    if (!submap.rect.contains(event.changed[c])) continue;
    ++inside;
    const bool is_shown = is_occupied(configuration.reflection.get(event.changed[c]));
    same += is_shown == (event.occupied[c] != 0) ? 1 : 0;
  }
  if (inside == 0 || 2 * inside < event.changed.size()) return std::nullopt;
  return static_cast<double>(same) / static_cast<double>(inside);
}
}  // namespace

std::optional<double> belief_in_state(const ChangeEvent& event, const patch::PatchMap& map,
                                      std::span<const localization::SubmapBelief> beliefs) {
  std::optional<double> belief;
  double best_share = kSameConfiguration;
  for (std::size_t s = 0; s < map.submaps.size(); ++s) {
    double best_here = 0.0;
    double sum = 0.0;
    for (std::size_t k = 0; k < map.submaps[s].configurations.size(); ++k) {
      const auto share = agreement(event, map.submaps[s], map.submaps[s].configurations[k]);
      if (!share || *share < kSameConfiguration) continue;
      sum += beliefs[s].probability[k];
      best_here = std::max(best_here, *share);
    }
    if (best_here < best_share || (belief && best_here == best_share)) continue;
    best_share = best_here;
    belief = sum;
  }
  return belief;
}

EventFollower::EventFollower(const TestScans& test, double limit_m)
    : test_(test), limit_m_(limit_m), outcomes_(test.changes ? test.changes->events.size() : 0) {
  views_.resize(test.observations.size());
  for (std::size_t e = 0; e < outcomes_.size(); ++e) {
    const auto& views = test.changes->events[e].views;
    predicted_.emplace_back(views.size());
    for (std::size_t v = 0; v < views.size(); ++v) views_[views[v].scan].emplace_back(e, v);
  }
}

void EventFollower::see(std::size_t scan, const maps::RangeFunction& expected_range) {
  for (const auto& [e, v] : views_[scan]) {
    predicted_[e][v] = count_predicted(scan, test_.changes->events[e].views[v], expected_range);
  }
}

std::vector<EventOutcome> EventFollower::take() {
  for (std::size_t e = 0; e < outcomes_.size(); ++e) {
    judge_adaptation(e);
    judge_consistency(e);
  }
  return std::move(outcomes_);
}

EventFollower::ViewCounts EventFollower::count_predicted(
    std::size_t scan_index, const ChangeView& view,
    const maps::RangeFunction& expected_range) const {
  const Scan& scan = test_.observations[scan_index].scan;
  const double limit_m = limit_of(scan);
  const Pose2 laser = *test_.truths[scan_index] * scan.robot_from_laser;
  ViewCounts counts;
  for (std::size_t b = 0; b < view.beams.size(); ++b) {
    const std::uint32_t beam = view.beams[b];
    const bool is_hit = scan.kind(beam) == BeamKind::kHit;
    const double measured_m =
        is_hit ? std::min(static_cast<double>(scan.ranges_m[beam]), limit_m) : limit_m;
    const double expected_m = std::min(expected_range(laser, scan.bearing_rad(beam)), limit_m);
    counts.as_now += std::abs(expected_m - measured_m) <= kBinTolerance_m ? 1 : 0;
    const auto before_m = static_cast<double>(view.before_m[b]);
    counts.as_before += std::abs(expected_m - before_m) <= kBinTolerance_m ? 1 : 0;
  }
  return counts;
}

/// The first view from which on, over kAdaptedWindow views, 90% of the changed bins are
/// predicted: a single scan often shows three bins of a change, which chance can predict.
void EventFollower::judge_adaptation(std::size_t e) {
  const std::vector<ChangeView>& views = test_.changes->events[e].views;
  const std::size_t window = std::min(kAdaptedWindow, views.size());
  for (std::size_t v = 0; v + window <= views.size(); ++v) {
    std::size_t bins = 0;
    std::size_t predicted = 0;
    for (std::size_t w = v; w < v + window; ++w) {
      bins += views[w].beams.size();
      predicted += predicted_[e][w].as_now;
    }
    if (static_cast<double>(predicted) < kAdaptedShare * static_cast<double>(bins)) continue;
    const auto stamp_of = [&](std::size_t view) {
      return test_.observations[views[view].scan].scan.stamp;
    };
    outcomes_[e].adapted_after_scans = static_cast<double>(v);
    outcomes_[e].adapted_after_s = (stamp_of(v) - stamp_of(0)).seconds();
    return;
  }
}

void EventFollower::judge_consistency(std::size_t e) {
  const std::vector<ChangeView>& views = test_.changes->events[e].views;
  std::size_t mixed = 0;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const double least = kMixedShare * static_cast<double>(views[v].beams.size());
    const ViewCounts& counts = predicted_[e][v];
    mixed += static_cast<double>(counts.as_now) >= least &&
                     static_cast<double>(counts.as_before) >= least
                 ? 1
                 : 0;
  }
  outcomes_[e].mixed_share = static_cast<double>(mixed) / static_cast<double>(views.size());
}

double EventFollower::limit_of(const Scan& scan) const {
  const auto own_m = static_cast<double>(scan.range_max_m);
  if (!tells_reach(scan.range_max_m)) return limit_m_ > 0.0 ? limit_m_ : 100.0;
  return limit_m_ > 0.0 ? std::min(own_m, limit_m_) : own_m;
}

}  // namespace strata::pipeline
