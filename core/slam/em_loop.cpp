// SPDX-License-Identifier: Apache-2.0
#include "core/slam/em_loop.hpp"

#include <algorithm>
#include <cmath>

#include "core/beam_filter/beam_filter.hpp"
#include "core/grid/count_scans.hpp"
#include "core/registration/scan_matcher.hpp"
#include "core/tracking/surface_map.hpp"
#include "core/tracking/tracker.hpp"
#include "core/tracking/tracker_parts.hpp"

namespace strata::slam {
namespace {

/// A fall of the log-likelihood by this share ends it (docs/theory/slam.md, "The EM loop").
constexpr double kFall = 0.01;
constexpr std::size_t kChunk = 64;

std::vector<const PosedScan*> mapped_scans(std::span<const PosedScan> scans,
                                           const std::vector<bool>& mapped) {
  std::vector<const PosedScan*> result;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    if (mapped[i]) result.push_back(&scans[i]);
  }
  return result;
}

/// What scans of the map can hit within max_range_m.
CellRect reach_of(std::span<const PosedScan* const> mapped, double max_range_m,
                  double resolution_m) {
  CellRect rect;
  for (const PosedScan* scan : mapped) {
    const Cell at = cell_at(scan->map_from_laser().translation(), resolution_m);
    rect = rect.united({at, {at.x + 1, at.y + 1}});
  }
  return rect.inflated(static_cast<int>(max_range_m / resolution_m) + 1);
}

/// Matches every scan that may move to the map of static beams.
void match_again(std::span<PosedScan> scans, const std::vector<bool>& mapped,
                 const std::vector<bool>& moves, const EmConfig& config,
                 const TrackingConfig& tracking, double resolution_m, WorkerPool& pool,
                 const CellRect& extent, Progress* progress) {
  SurfaceMap map(resolution_m, tracking.field);
  map.reserve(extent);
  for (std::size_t i = 0; i < scans.size(); ++i) {
    if (i % 512 == 0) report_progress(progress, "map static beams", i, scans.size());
    if (!mapped[i]) continue;
    map.add(scans[i].scan, scans[i].map_from_laser(), scans[i].static_probability,
            tracking.max_range_m, false);
  }
  map.forget_counts();
  registration::MatchConfig near = tracking.match;
  near.levels = 1;  // every scan is near its place
  report_progress(progress, "match again", 0, scans.size());
  pool.for_chunks(scans.size(), kChunk, [&](std::size_t begin, std::size_t end, std::size_t) {
    for (std::size_t i = begin; i < end; ++i) {
      if (!moves[i]) continue;
      PosedScan& scan = scans[i];
      const Endpoints endpoints =
          match_endpoints(scan.scan, tracking.max_range_m, tracking.max_beams);
      if (endpoints.size() < kMinHits) continue;
      const Pose2Gaussian prior{scan.map_from_robot,
                                pose_covariance(config.prior_stddev_m, config.prior_stddev_rad)};
      const registration::MatchResult result = registration::match(
          endpoints, scan.static_probability, map.field(), scan.map_from_robot, &prior, near);
      if (result.converged) scan.map_from_robot = result.pose;
    }
  });
}

}  // namespace

EmResult run_em(std::span<PosedScan> scans, const std::vector<bool>& mapped,
                const std::vector<bool>& moves, const EmConfig& config,
                const TrackingConfig& tracking, const beam_filter::BeamFilterConfig& filter,
                WorkerPool& pool, Progress* progress) {
  EmResult best;
  best.raw = CountingMap(filter.resolution_m);
  const bool any_moves = std::find(moves.begin(), moves.end(), true) != moves.end();
  const int rounds = any_moves && config.match_again ? config.max_iterations : 0;
  std::vector<Pose2> best_poses(scans.size());
  bool has_best_raw = false;  // else it is counted again at the best poses
  std::vector<double> trace;
  const std::vector<const PosedScan*> counted = mapped_scans(scans, mapped);
  CellRect extent;  // of the counts at the present poses
  // Within the loop each cell is judged by itself: matching wants walls as thin as they come.
  beam_filter::BeamFilterConfig strict = filter;
  strict.endpoint_tolerance = false;
  const auto count = [&] {
    return count_scans(counted, filter.resolution_m, filter.counting, BeamWeights::kAllStatic, pool,
                       progress);
  };
  int small_gains = 0;
  for (int round = 0; round <= rounds; ++round) {
    if (round > 0) {
      // Counts are what takes most memory: never those of two rounds at once.
      best.raw = CountingMap(filter.resolution_m);
      has_best_raw = false;
      beam_filter::label_all(scans, best.filtered, strict, pool, progress);
      const CellRect reach = reach_of(counted, tracking.max_range_m, filter.resolution_m);
      match_again(scans, mapped, moves, config, tracking, filter.resolution_m, pool,
                  extent.intersected(reach), progress);
    }
    CountingMap raw = count();
    extent = raw.cells().rect();
    beam_filter::CountsResult counts = beam_filter::filter_counts(raw, strict);
    const double now = counts.log_likelihood.empty() ? 0.0 : counts.log_likelihood.back();
    if (trace.empty() || now > *std::max_element(trace.begin(), trace.end())) {
      best.raw = std::move(raw);
      has_best_raw = true;
      best.filtered = std::move(counts.filtered);
      best.iterations = round;
      for (std::size_t i = 0; i < scans.size(); ++i) best_poses[i] = scans[i].map_from_robot;
    }
    const double gain = trace.empty() ? 0.0 : now - trace.back();
    const double scale = trace.empty() ? 1.0 : std::abs(trace.back());
    const bool first = trace.empty();
    trace.push_back(now);
    if (first) continue;
    if (gain < -kFall * scale) break;
    small_gains = gain < config.min_gain * scale ? small_gains + 1 : 0;
    if (small_gains >= 2) break;
  }
  for (std::size_t i = 0; i < scans.size(); ++i) scans[i].map_from_robot = best_poses[i];
  if (!has_best_raw) best.raw = count();
  if (filter.endpoint_tolerance) best.filtered = filter_counts(best.raw, filter).filtered;
  best.dynamic_fraction = beam_filter::label_all(scans, best.filtered, filter, pool, progress);
  best.log_likelihood = std::move(trace);
  return best;
}

}  // namespace strata::slam
