// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/learn.hpp"

#include "core/grid/blind_beams.hpp"
#include "core/patch/patch_learner.hpp"
#include "core/patch/without_change.hpp"
#include "tools/pipeline/keep_base.hpp"
#include "tools/pipeline/learn_within.hpp"

namespace strata::pipeline {

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
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const bool given = i < given_poses.size() && given_poses[i].has_value();
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
