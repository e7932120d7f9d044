// SPDX-License-Identifier: Apache-2.0
// The end of a log: what needs all its data.
#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "core/slam/em_loop.hpp"
#include "core/slam/learned_surfaces.hpp"
#include "core/slam/slam_state.hpp"

namespace strata::slam {

void forget_maps(SlamResult& result) {
  result.raw = CountingMap(result.raw.resolution_m());
  result.occupancy = {};
  result.filtered = {};
}

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
  graph.forget_surfaces();
  improve(result, rounds, progress);
  return result;
}

void Slam::State::improve(SlamResult& result, int rounds, Progress* progress) {
  forget_maps(result);
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

namespace {

std::string inconsistent(const Consistency& consistency) {
  const ComparedStretches& worst = consistency.places.front();
  std::ostringstream text;
  text << std::fixed << std::setprecision(0) << "the map contradicts itself at "
       << consistency.places.size() << (consistency.places.size() == 1 ? " place" : " places")
       << ", most near (" << std::setprecision(1) << worst.x_m << ", " << worst.y_m
       << "): " << std::setprecision(0) << 100.0 * worst.share
       << "% of the surfaces that one of two ways there saw are free by the other; it is folded or "
          "bent there, and not to be trusted";
  for (const int run : consistency.against_others) {
    text << (run == consistency.against_others.front()
                 ? "; by themselves contradict the others: run "
                 : ", run ")
         << run;
  }
  return text.str();
}

}  // namespace

/// Makes the maps anew where beams without return say something: at the poses that were found
/// without them. Used before, they change which beams are held to be static, and so the poses.
void Slam::State::free_along_no_returns(SlamResult& result, Progress* progress) {
  result.drop_outs = find_drop_outs(result.scans, config.no_return, pool);
  if (result.drop_outs.free_range_m <= 0.0) return;
  std::vector<double> trace = std::move(result.log_likelihood);
  const int iterations = result.iterations;
  improve(result, 0, progress);
  result.log_likelihood = std::move(trace);
  result.iterations = iterations;
}

SlamResult Slam::finish(Progress* progress) {
  SlamResult result = finish_passes(progress);
  state_->free_along_no_returns(result, progress);
  result.surfaces = learned_surfaces(result.scans, result.filtered.resolution_m());
  result.consistency = check_consistency(result.scans, state_->pool);
  if (!result.consistency.consistent) result.warnings.push_back(inconsistent(result.consistency));
  return result;
}

}  // namespace strata::slam
