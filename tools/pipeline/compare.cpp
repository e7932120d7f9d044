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
#include "tools/pipeline/join_comparisons.hpp"
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

/// One a split of these, side by side.
std::vector<Prepared> prepare(const Runs& runs, std::span<const std::size_t> splits,
                              const Poses& poses, const CompareConfig& config,
                              const CompareConfig& same_for_all, const CompareJob& job,
                              WorkerPool& pool) {
  const std::vector<double> elapsed = elapsed_seconds(runs.observations);
  std::vector<Prepared> prepared(splits.size());
  pool.for_chunks(splits.size(), 1, [&](std::size_t i, std::size_t /*end*/, std::size_t /*chunk*/) {
    const Split& split = job.splits[splits[i]];
    auto& [learned, parts] = prepared[i];
    learned = learn_split(runs, split, poses, config, job);
    parts = make_test_parts(runs, split, elapsed, learned.truths, config.protocol);
    for (TestPart& part : parts) {
      look_for_changes(learned.result.slam.scans, learned.maps.filtered, same_for_all, part);
    }
  });
  return prepared;
}

/// Everything but its drives.
Comparison without_drives(const CompareConfig& config, const CompareJob& job, TruthKind truth) {
  Comparison comparison;
  comparison.log = job.log;
  comparison.via = job.via;
  comparison.seeds = job.seeds.size();
  comparison.truth = truth;
  for (const std::string& model : config.protocol.models)
    comparison.models.emplace_back().model = model;
  for (const Peer& peer : job.peers) comparison.models.emplace_back().model = peer.name;
  return comparison;
}

/// The job with a share for each split.
CompareJob with_shares(CompareJob job) {
  if (job.shares.empty()) job.shares.assign(job.splits.size(), {job.seeds, true});
  return job;
}

/// Of the localizer, in all shares.
std::size_t count_runs(const Runs& runs, const CompareConfig& config, const CompareJob& job) {
  const std::size_t models = config.protocol.models.size() + job.peers.size();
  std::size_t count = 0;
  std::size_t scored = 0;
  for (std::size_t s = 0; s < job.splits.size(); ++s) {
    count += count_drives(runs, {job.splits[s]}) * models * job.shares[s].seeds.size();
    scored += job.shares[s].with_scores && !job.shares[s].seeds.empty() ? 1 : 0;
  }
  return count + count_memory_runs(runs, config, job) * scored / job.splits.size();
}

/// Localizes in a split as far as the share goes, and scores it.
void compare_split(const Runs& runs, const Prepared& prepared, std::size_t split,
                   const CompareConfig& config, const CompareJob& job, WorkerPool& pool,
                   SharedProgress& progress, Comparison& comparison) {
  const auto& [learned, parts] = prepared;
  const SplitShare& share = job.shares[split];
  const std::vector<maps::MapModel> map_models = make_models(learned.maps, config, job);
  const LocalizeFunction localize_one = job.localize_with
                                            ? job.localize_with(learned.result, config)
                                            : LocalizeFunction(localize_here);
  for (const TestPart& part : parts) {
    const std::size_t index = comparison.parts.size();
    run_candidates(make_candidates(map_models, localize_one, job.peers, learned, config, part),
                   part, index, share.seeds, pool, progress, comparison.models);
    if (share.with_scores) {
      score_models(map_models, part, index, learned.maps, config, pool, comparison.models);
    }
    comparison.parts.push_back(part.info);
  }
  if (!share.with_scores) return;
  add_memory_curves(runs, {job.splits[split], learned, parts}, config, job, pool, progress,
                    comparison.models);
}

}  // namespace

std::size_t seeds_for_scores(const CompareConfig& config, std::size_t seeds) {
  const auto memory = static_cast<std::size_t>(config.protocol.memory_seeds);
  return std::min(seeds, std::max(memory, kOwnPoseSeeds));
}

SplitOutcomes compare_splits(const Runs& runs, const CompareConfig& config,
                             const CompareJob& asked) {
  require_valid(config, "compare");
  for (const Split& split : asked.splits) require_parts(split, asked);
  for (const std::string& model : config.protocol.models) (void)asked.map_models->at(model);
  CompareJob job = with_shares(asked);
  // Localizing takes most of the time, so that the time left is about that of the whole job.
  SharedProgress progress(asked.progress, "compare", count_runs(runs, config, job));
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
  const TruthKind truth = has_truth || has_poses ? TruthKind::kGiven : TruthKind::kJointTrajectory;
  SplitOutcomes outcomes;
  outcomes.splits.assign(job.splits.size(), without_drives(config, job, truth));
  std::vector<std::size_t> todo;
  for (std::size_t s = 0; s < job.splits.size(); ++s) {
    if (!job.shares[s].seeds.empty()) todo.push_back(s);
  }
  WorkerPool pool(job.jobs > 0 ? job.jobs : job.threads);
  // Not all splits at once: each holds its scans.
  const auto at_once = 2 * static_cast<std::size_t>(pool.threads());
  std::vector<Prepared> group;
  for (std::size_t i = 0; i < todo.size(); ++i) {
    if (i % at_once == 0) {
      const auto next = std::span<const std::size_t>(todo).subspan(i);
      group.clear();
      group = prepare(runs, next.first(std::min(at_once, next.size())), poses, config, same_for_all,
                      job, pool);
    }
    Prepared& prepared = group[i % at_once];
    compare_split(runs, prepared, todo[i], same_for_all, job, pool, progress,
                  outcomes.splits[todo[i]]);
    if (todo[i] > 0) continue;
    outcomes.learned = std::move(prepared.learned.result);
    outcomes.maps = std::move(prepared.learned.maps);
    outcomes.drive = std::move(prepared.parts.front());
  }
  return outcomes;
}

CompareOutcome compare(const Runs& runs, const CompareConfig& config, const CompareJob& job) {
  SplitOutcomes outcomes = compare_splits(runs, config, job);
  return {join_splits(std::move(outcomes.splits)), std::move(outcomes.learned),
          std::move(outcomes.maps), std::move(outcomes.drive)};
}

}  // namespace strata::pipeline
