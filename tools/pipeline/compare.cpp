// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/compare.hpp"

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "core/base/error.hpp"
#include "core/base/parallel.hpp"
#include "tools/pipeline/candidates.hpp"
#include "tools/pipeline/equal_memory.hpp"
#include "tools/pipeline/learned_maps.hpp"
#include "tools/pipeline/model_scores.hpp"
#include "tools/pipeline/test_part.hpp"

namespace strata::pipeline {
namespace {

void require_parts(const Split& split, const CompareJob& job) {
  if (!split.train.empty() && !split.test.empty()) return;
  throw InputError(job.log, "leaves nothing to learn from or nothing to test on",
                   "choose another split with --train-until");
}

/// A split's maps, and the drives to test them on.
struct Prepared {
  Learned learned;
  std::vector<TestPart> parts;
};

/// One a split, side by side.
std::vector<Prepared> prepare(const Runs& runs, std::span<const Split> splits, const Poses& poses,
                              const CompareConfig& config, const CompareConfig& same_for_all,
                              const CompareJob& job, WorkerPool& pool) {
  const std::vector<double> elapsed = elapsed_seconds(runs.observations);
  std::vector<Prepared> prepared(splits.size());
  pool.for_chunks(splits.size(), 1, [&](std::size_t i, std::size_t /*end*/, std::size_t /*chunk*/) {
    auto& [learned, parts] = prepared[i];
    learned = learn_split(runs, splits[i], poses, config, job);
    parts = make_test_parts(runs, splits[i], elapsed, learned.truths, config.protocol);
    for (TestPart& part : parts) {
      look_for_changes(learned.result.slam.scans, learned.maps.filtered, same_for_all, part);
    }
  });
  return prepared;
}

}  // namespace

CompareOutcome compare(const Runs& runs, const CompareConfig& config, const CompareJob& asked) {
  require_valid(config, "compare");
  for (const Split& split : asked.splits) require_parts(split, asked);
  for (const std::string& model : config.protocol.models) (void)asked.map_models->at(model);
  // Localizing takes most of the time, so that the time left is about that of the whole job.
  const std::size_t models = config.protocol.models.size() + asked.peers.size();
  SharedProgress progress(asked.progress, "compare",
                          count_drives(runs, asked.splits) * models * asked.seeds.size() +
                              count_memory_runs(runs, config, asked));
  CompareJob job = asked;
  job.progress = &progress;
  const bool has_truth = any_known(runs.truths);
  const bool has_poses = any_known(runs.poses);
  Poses poses = runs.poses;
  if (!has_poses && (!has_truth || job.splits.size() > 1)) {
    poses = joint_trajectory(runs, config, job.threads, job.progress);
  }
  CompareConfig same_for_all = config;
  if (double& reach_m = same_for_all.sensor.beam.beams.max_range_m; reach_m == 0.0) {
    // The same reach for all: timescale nodes know nothing beyond theirs.
    reach_m = config.learn.timescale.max_range_m;
  }
  CompareOutcome outcome;
  Comparison& comparison = outcome.comparison;
  comparison.log = job.log;
  comparison.via = job.via;
  comparison.seeds = job.seeds.size();
  comparison.truth = has_truth || has_poses ? TruthKind::kGiven : TruthKind::kJointTrajectory;
  for (const std::string& model : config.protocol.models)
    comparison.models.emplace_back().model = model;
  for (const Peer& peer : job.peers) comparison.models.emplace_back().model = peer.name;
  WorkerPool pool(job.jobs > 0 ? job.jobs : job.threads);
  // Not all splits at once: each holds its scans.
  const auto at_once = 2 * static_cast<std::size_t>(pool.threads());
  std::vector<Prepared> group;
  for (std::size_t s = 0; s < job.splits.size(); ++s) {
    if (s % at_once == 0) {
      const auto splits = std::span(job.splits).subspan(s);
      group.clear();
      group = prepare(runs, splits.first(std::min(at_once, splits.size())), poses, config,
                      same_for_all, job, pool);
    }
    auto& [learned, parts] = group[s % at_once];
    const std::vector<maps::MapModel> map_models = make_models(learned.maps, same_for_all, job);
    const LocalizeFunction localize_one = job.localize_with
                                              ? job.localize_with(learned.result, same_for_all)
                                              : LocalizeFunction(localize_here);
    for (const TestPart& part : parts) {
      run_candidates(
          make_candidates(map_models, localize_one, job.peers, learned, same_for_all, part), part,
          comparison.parts.size(), job.seeds, pool, progress, comparison.models);
      score_models(map_models, part, comparison.parts.size(), learned.maps, same_for_all, pool,
                   comparison.models);
      comparison.parts.push_back(part.info);
    }
    add_memory_curves(runs, {job.splits[s], learned, parts}, same_for_all, job, pool, progress,
                      comparison.models);
    if (s > 0) continue;
    outcome.learned = std::move(learned.result);
    outcome.maps = std::move(learned.maps);
  }
  return outcome;
}

}  // namespace strata::pipeline
