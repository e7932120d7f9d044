// SPDX-License-Identifier: Apache-2.0
// The passes over a whole log, each of which has to prove that it is better than the one before.
#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/slam/slam_state.hpp"

namespace strata::slam {
namespace {

/// Fewer dynamic beams than this do not bend a trajectory.
constexpr double kWorthTrackingAgain = 0.003;

/// Rounds of EM before that: enough to tell which beams are dynamic.
constexpr int kRoundsBefore = 3;

/// The log is tracked once more than once only where the map still contradicts itself: what the
/// better map holds to be dynamic may be what bent it.
constexpr int kTracksAgain = 2;

/// Contradictions of a later pass, against those of an earlier one, that it has to be below.
constexpr double kClearlyLess = 0.7;

/// Loops of a map that contradicts itself may lie further apart than the drift that is expected.
constexpr double kWider = 2.0;

/// Of the cells in which the ways of an earlier pass agree: how many more have to, less those that
/// contradict, where loops that were found for it are to count by that alone.
constexpr double kClearlyMore = 0.03;

ClosureConfig wider(ClosureConfig closure) {
  closure.drift_m_per_m *= kWider;
  closure.drift_rad_per_m *= kWider;
  closure.max_window_m *= kWider;
  return closure;
}

}  // namespace

void Slam::State::track_again(SlamResult& before, State& again) {
  again.checks.skip_as(checks);
  std::size_t next = 0;
  for (Record& record : records) {
    PosedScan& posed = record.used ? before.scans[next++] : record.posed;
    if (&record == &records.front() || record.posed.run != (&record - 1)->posed.run) {
      const auto begun = std::find_if(begun_at.begin(), begun_at.end(),
                                      [&](const auto& known) { return known.first == posed.run; });
      if (begun != begun_at.end()) again.next_start = begun->second;
    }
    const Observation observation{posed.run, std::move(posed.scan),
                                  record.odometry.value_or(Pose2{}), record.odometry.has_value()};
    again.add(observation, record.given ? &*record.given : nullptr, record.placed,
              posed.static_probability);
  }
}

bool EarlierPass::is_preferred_to(const Consistency& now) const {
  return !now.consistent && static_cast<double>(now.contradicting) >
                                kClearlyLess * static_cast<double>(consistency.contradicting);
}

bool EarlierPass::is_of(const SlamResult& result) const {
  return std::equal(result.scans.begin(), result.scans.end(), stamps.begin(), stamps.end(),
                    [](const PosedScan& scan, Stamp stamp) { return scan.scan.stamp == stamp; });
}

EarlierPass Slam::State::pass_of(const SlamResult& result) {
  EarlierPass pass;
  pass.consistency = check_consistency(result.scans, pool);
  pass.mapped = mapped;
  pass.moves = moves;
  pass.loop_closures = result.loop_closures;
  pass.warnings = result.warnings;
  for (const PosedScan& scan : result.scans) {
    pass.poses.push_back(scan.map_from_robot);
    pass.stamps.push_back(scan.scan.stamp);
  }
  return pass;
}

void Slam::State::go_back(const EarlierPass& before, SlamResult& result, Progress* progress) {
  for (std::size_t i = 0; i < before.poses.size(); ++i) {
    result.scans[i].map_from_robot = before.poses[i];
    result.scans[i].static_probability.clear();
  }
  mapped = before.mapped;
  moves = before.moves;
  result.loop_closures = before.loop_closures;
  result.warnings = before.warnings;
  improve(result, config.em.max_iterations, progress);
}

bool EarlierPass::is_outdone_by(const Consistency& now) const {
  const double more_cells = now.agreement_cells() - consistency.agreement_cells();
  // Ways that were torn apart contradict each other in nothing.
  if (!is_preferred_to(now) && more_cells >= 0.0) return true;
  return more_cells > kClearlyMore * static_cast<double>(consistency.fitting_cells);
}

SlamResult Slam::track_anew(SlamResult result, const ClosureConfig& closure, Progress* progress) {
  forget_maps(result);
  SlamConfig config = state_->config;
  config.closure = closure;
  auto again = std::make_unique<State>(config, state_->pool.threads(), KeepConfig{});
  state_->track_again(result, *again);
  again->config.closure = state_->config.closure;
  state_ = std::move(again);
  return state_->finish(state_->config.em.max_iterations, progress);
}

/// Where the map contradicts itself, loops are searched for as if poses drifted more.
SlamResult Slam::finish_passes(Progress* progress) {
  SlamResult result = finish_usual_passes(progress);
  const SlamConfig config = state_->config;  // track_anew makes another state
  const std::vector<bool>& moves = state_->moves;
  if (!config.em.track_again || !config.closure.enabled || state_->forgot ||
      std::find(moves.begin(), moves.end(), true) == moves.end()) {
    return result;
  }
  const EarlierPass before = state_->pass_of(result);
  if (before.consistency.consistent) return result;
  // What a folded map holds to be dynamic is no guide.
  for (PosedScan& scan : result.scans) scan.static_probability.clear();
  result = track_anew(std::move(result), wider(config.closure), progress);
  if (before.is_outdone_by(check_consistency(result.scans, state_->pool))) return result;
  if (!before.is_of(result)) {
    for (PosedScan& scan : result.scans) scan.static_probability.clear();
    return track_anew(std::move(result), config.closure, progress);
  }
  state_->go_back(before, result, progress);
  return result;
}

SlamResult Slam::finish_usual_passes(Progress* progress) {
  const EmConfig& em = state_->config.em;
  if (!em.track_again || state_->forgot) return state_->finish(em.max_iterations, progress);
  SlamResult result = state_->finish(kRoundsBefore, progress);
  const std::vector<bool>& moves = state_->moves;
  if (std::find(moves.begin(), moves.end(), true) == moves.end()) return result;
  if (result.dynamic_fraction < kWorthTrackingAgain) {
    // The trace goes on from its best round.
    std::vector<double> trace(result.log_likelihood.begin(),
                              result.log_likelihood.begin() + result.iterations + 1);
    state_->improve(result, em.max_iterations, progress);
    result.iterations += static_cast<int>(trace.size()) - 1;
    trace.insert(trace.end(), result.log_likelihood.begin() + 1, result.log_likelihood.end());
    result.log_likelihood = std::move(trace);
    return result;
  }
  for (int time = 0; time < kTracksAgain; ++time) {
    const EarlierPass before = state_->pass_of(result);
    result = track_anew(std::move(result), state_->config.closure, progress);
    if (!before.is_of(result)) return result;
    const Consistency now = check_consistency(result.scans, state_->pool);
    if (before.is_preferred_to(now)) state_->go_back(before, result, progress);
    if (now.consistent || before.is_preferred_to(now)) return result;
  }
  return result;
}

}  // namespace strata::slam
