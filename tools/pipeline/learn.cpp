// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/learn.hpp"

#include "core/patch/patch_learner.hpp"

namespace strata::pipeline {

LearnResult learn(const std::vector<Observation>& observations,
                  const std::vector<std::optional<Pose2>>& given_poses,
                  const maps::LearnConfig& config, const LearnParts& parts, std::uint64_t seed,
                  int threads, Progress* progress) {
  LearnResult result;
  slam::Slam slam(config.slam, threads);
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const bool given = i < given_poses.size() && given_poses[i].has_value();
    slam.add(observations[i], given ? &*given_poses[i] : nullptr);
    report_progress(progress, "match scans", i + 1, observations.size());
  }
  result.slam = slam.finish(progress);

  if (parts.patch) {
    patch::PatchLearner learner(config.patch, threads);
    for (const PosedScan& scan : result.slam.scans) learner.add(scan);
    result.patches = learner.finish(result.slam.filtered, progress);
  } else {
    result.patches.base = result.slam.filtered;
  }

  if (parts.timescale) {
    result.timescale = std::make_shared<memory::TimescaleMemory>(config.timescale, seed);
    for (std::size_t i = 0; i < result.slam.scans.size(); ++i) {
      result.timescale->observe(result.slam.scans[i]);
      report_progress(progress, "remember scans", i + 1, result.slam.scans.size());
    }
  }
  return result;
}

}  // namespace strata::pipeline
