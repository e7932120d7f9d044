// SPDX-License-Identifier: Apache-2.0
// The end of a log: what needs all its data.
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/slam/em_loop.hpp"
#include "core/slam/slam_state.hpp"

namespace strata::slam {
namespace {

/// Fewer dynamic beams than this do not bend a trajectory.
constexpr double kWorthTrackingAgain = 0.003;

/// Rounds of EM before that: enough to tell which beams are dynamic.
constexpr int kRoundsBefore = 3;

}  // namespace

/// Each scan goes with its local map; between the middles of two local maps of a run the correction
/// passes over smoothly, so that the trajectory does not jump where one takes over.
void Slam::State::place_scans() {
  for (Record& record : records) {
    if (stays(record)) {
      record.posed.map_from_robot = *record.given;
      continue;
    }
    const std::size_t own = record.local_map;
    if (own == kNoLocalMap) {
      record.posed.map_from_robot = record.run_from_robot;
      continue;
    }
    const LocalMap& local_map = graph.local_map(own);
    const double middle = 0.5 * static_cast<double>(local_map.first_scan + local_map.last_scan);
    const bool later = static_cast<double>(record.number) >= middle;
    const std::size_t other = later ? own + 1 : own - 1;
    const Pose2 here = graph.map_from_run(own) * record.run_from_robot;
    record.posed.map_from_robot = here;
    if ((!later && own == 0) || other >= graph.size()) continue;
    const LocalMap& next = graph.local_map(other);
    // The one between them may be forgotten.
    const bool beside =
        next.first_scan == local_map.last_scan || next.last_scan == local_map.first_scan;
    if (next.run != local_map.run || !beside) continue;
    const double other_middle = 0.5 * static_cast<double>(next.first_scan + next.last_scan);
    const double t = (static_cast<double>(record.number) - middle) / (other_middle - middle);
    record.posed.map_from_robot =
        interpolate(here, graph.map_from_run(other) * record.run_from_robot, t);
  }
}

SlamResult Slam::State::finish(int rounds, Progress* progress) {
  end_run();
  const bool all_stay = std::all_of(records.begin(), records.end(),
                                    [&](const Record& record) { return stays(record); });
  if (!all_stay) graph.tighten(2, progress);
  place_scans();
  SlamResult result;
  result.skipped_scans = checks.skipped();
  result.warnings = checks.warnings();
  result.loop_closures = graph.closures();
  for (Record& record : records) {
    record.used = stays(record) || located(record);
    if (!record.used) {
      if (result.unplaced_runs.empty() || result.unplaced_runs.back() != record.posed.run) {
        result.unplaced_runs.push_back(record.posed.run);
      }
      continue;
    }
    mapped.push_back(record.key);
    moves.push_back(!stays(record));
    result.scans.push_back(std::move(record.posed));
  }
  improve(result, rounds, progress);
  return result;
}

void Slam::State::improve(SlamResult& result, int rounds, Progress* progress) {
  EmConfig at_most = config.em;
  at_most.max_iterations = std::min(rounds, config.em.max_iterations);
  EmResult em = run_em(result.scans, mapped, moves, at_most, config.tracking, config.beam_filter,
                       pool, progress);
  result.raw = std::move(em.raw);
  result.occupancy = result.raw.reflection(config.beam_filter.min_evidence);
  result.filtered = std::move(em.filtered);
  result.log_likelihood = std::move(em.log_likelihood);
  result.iterations = em.iterations;
  result.dynamic_fraction = em.dynamic_fraction;
}

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

SlamResult Slam::finish(Progress* progress) {
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
  auto again = std::make_unique<State>(state_->config, state_->pool.threads(), KeepConfig{});
  state_->track_again(result, *again);
  state_ = std::move(again);
  return state_->finish(state_->config.em.max_iterations, progress);
}

}  // namespace strata::slam
