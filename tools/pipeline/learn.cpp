// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/learn.hpp"

#include <algorithm>
#include <map>

#include "core/grid/blind_beams.hpp"
#include "core/patch/patch_learner.hpp"
#include "core/patch/without_change.hpp"
#include "tools/pipeline/keep_base.hpp"
#include "tools/pipeline/learn_within.hpp"

namespace strata::pipeline {
namespace {

/// How far off the place of a run may be that was found in the map with the region.
constexpr double kStartStddev_m = 0.05;
constexpr double kStartStddev_rad = 0.01;

using Starts = std::map<int, Pose2Gaussian>;

/// Where new runs begin in the map of all that earlier ones saw: without the region that is
/// forgotten too little of it may be left to know their places by. Runs that have none are left
/// out.
Starts starts_of(const std::vector<Observation>& observations, const std::vector<PosedScan>& placed,
                 slam::SlamConfig config, int threads, Progress* progress) {
  config.em.match_again = false;
  config.em.track_again = false;
  slam::Slam slam(config, threads);
  for (const PosedScan& scan : placed) slam.add_placed(scan);
  for (std::size_t i = 0; i < observations.size(); ++i) {
    slam.add(observations[i]);
    report_progress(progress, "find where runs begin", i + 1, observations.size());
  }
  Starts starts;
  for (const PosedScan& scan : slam.finish(progress).scans) {
    starts.try_emplace(scan.run, Pose2Gaussian{scan.map_from_robot,
                                               pose_covariance(kStartStddev_m, kStartStddev_rad)});
  }
  return starts;
}

}  // namespace

LearnResult learn(const std::vector<Observation>& observations,
                  const std::vector<std::optional<Pose2>>& given_poses,
                  const maps::LearnConfig& config, const LearnParts& parts, std::uint64_t seed,
                  int threads, Progress* progress, maps::EarlierRuns* earlier) {
  return learn_within({}, observations, given_poses, config, parts, seed, threads, progress,
                      earlier);
}

LearnResult learn_within(const LearnWithin& limits, const std::vector<Observation>& observations,
                         const std::vector<std::optional<Pose2>>& given_poses,
                         const maps::LearnConfig& config, const LearnParts& parts,
                         std::uint64_t seed, int threads, Progress* progress,
                         maps::EarlierRuns* earlier) {
  require_same_cells(limits, config.slam.beam_filter.resolution_m);
  LearnResult result;
  if (earlier != nullptr) result.forgotten_scans = maps::forget_scans(*earlier, config.history);
  slam::Slam slam(config.slam, threads);
  const std::vector<PosedScan> none;
  const std::vector<PosedScan>& placed = earlier != nullptr ? earlier->scans : none;
  for (std::size_t i = 0; i < placed.size(); ++i) {
    if (limits.forgets && placed[i].run < earlier->next_run) {
      PosedScan scan = placed[i];
      (void)blind_beams(scan, limits.only);
      slam.add_placed(scan);
    } else {
      slam.add_placed(placed[i]);
    }
    report_progress(progress, "match earlier scans", i + 1, placed.size());
  }
  Starts starts;
  const bool are_given = std::any_of(given_poses.begin(), given_poses.end(),
                                     [](const auto& pose) { return pose.has_value(); });
  if (limits.forgets && !are_given) {
    starts = starts_of(observations, placed, config.slam, threads, progress);
  }
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const bool given = i < given_poses.size() && given_poses[i].has_value();
    const bool begins = i == 0 || observations[i].run != observations[i - 1].run;
    const auto start = starts.find(observations[i].run);
    if (begins && start != starts.end()) slam.begin_next_run_at(start->second);
    slam.add(observations[i], given ? &*given_poses[i] : nullptr);
    report_progress(progress, "match scans", i + 1, observations.size());
  }
  result.slam = slam.finish(progress);
  keep_base(limits, earlier != nullptr ? earlier->next_run : 0, result.slam);

  if (parts.patch) {
    patch::PatchLearner learner(config.patch, threads);
    for (const PosedScan& scan : result.slam.scans) learner.add(scan);
    result.patches = learner.finish(result.slam.filtered, progress);
    patch::keep_static(result.patches, limits.static_only);
  }

  if (parts.timescale) {
    const bool goes_on = earlier != nullptr && earlier->timescale != nullptr;
    result.timescale = goes_on ? earlier->timescale
                               : std::make_shared<memory::TimescaleMemory>(config.timescale, seed);
    for (std::size_t i = 0; i < result.slam.scans.size(); ++i) {
      const PosedScan& scan = result.slam.scans[i];
      if (!goes_on || scan.run >= earlier->next_run) result.timescale->observe(scan);
      report_progress(progress, "remember scans", i + 1, result.slam.scans.size());
    }
    result.timescale->close_day();
  }
  return result;
}

}  // namespace strata::pipeline
