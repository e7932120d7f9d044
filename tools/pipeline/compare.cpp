// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/compare.hpp"

#include <utility>

#include "core/base/error.hpp"
#include "core/base/parallel.hpp"
#include "tools/pipeline/candidates.hpp"
#include "tools/pipeline/learned_maps.hpp"
#include "tools/pipeline/scan_prediction.hpp"
#include "tools/pipeline/test_part.hpp"

namespace strata::pipeline {
namespace {

/// timescale_frozen stays as it was learned.
bool follows_timescale(const std::string& model) {
  return model.starts_with("timescale") && model != "timescale_frozen";
}

/// Held-out fit and adaptation of every model. The timescale memory goes on learning for the
/// latter, as it would on the robot; grids are what they are, and patch models follow by beliefs.
void predict_with_models(const std::vector<maps::MapModel>& models, const TestPart& part,
                         const maps::Maps& maps, const CompareConfig& config, WorkerPool& pool,
                         Comparison& comparison) {
  const TestScans test{part.observations, part.truths, &part.changes};
  std::vector<PredictionScore> scores(models.size());
  pool.for_chunks(models.size(), 1, [&](std::size_t m, std::size_t, std::size_t) {
    scores[m] =
        score_predictions(test, models[m], config.sensor.beam, config.protocol.prediction_every);
  });
  std::vector<std::string> names;
  for (const maps::MapModel& model : models) {
    if (follows_timescale(model.name)) names.push_back(model.name);
  }
  if (!names.empty() && !part.changes.events.empty()) {
    const auto followed = follow_timescale(test, maps, names, config.sensor);
    std::size_t next = 0;
    for (std::size_t m = 0; m < models.size(); ++m) {
      if (!follows_timescale(models[m].name)) continue;
      for (std::size_t e = 0; e < followed[next].size(); ++e) {
        scores[m].events[e].adapted_after_scans = followed[next][e].adapted_after_scans;
        scores[m].events[e].adapted_after_s = followed[next][e].adapted_after_s;
      }
      ++next;
    }
  }
  for (std::size_t m = 0; m < models.size(); ++m) {
    comparison.models[m].scores.push_back(std::move(scores[m]));
  }
}

std::vector<maps::MapModel> make_models(const maps::Maps& maps, const CompareConfig& config) {
  std::vector<maps::MapModel> models;
  for (const std::string& name : config.protocol.models) {
    models.push_back(maps::make_map_model(maps, name, config.sensor));
  }
  return models;
}

void require_parts(const Split& split, const CompareJob& job) {
  if (!split.train.empty() && !split.test.empty()) return;
  throw InputError(job.log, "leaves nothing to learn from or nothing to test on",
                   "choose another split with --train-until");
}

}  // namespace

CompareOutcome compare(const Runs& runs, const CompareConfig& config, const CompareJob& job) {
  require_valid(config, "compare");
  for (const Split& split : job.splits) require_parts(split, job);
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
  const std::vector<std::string>& models = config.protocol.models;
  for (const std::string& model : models) comparison.models.emplace_back().model = model;
  for (const Peer& peer : job.peers) comparison.models.emplace_back().model = peer.name;
  const std::vector<double> elapsed = elapsed_seconds(runs.observations);
  WorkerPool pool(job.jobs > 0 ? job.jobs : job.threads);
  SharedProgress progress(
      job.progress, count_drives(runs, job.splits) * comparison.models.size() * job.seeds.size());
  for (std::size_t s = 0; s < job.splits.size(); ++s) {
    Learned learned = learn_split(runs, job.splits[s], poses, config, job);
    const std::vector<maps::MapModel> map_models = make_models(learned.maps, same_for_all);
    const LocalizeFunction localize_one = job.localize_with
                                              ? job.localize_with(learned.result, same_for_all)
                                              : LocalizeFunction(localize_here);
    for (TestPart& part :
         make_test_parts(runs, job.splits[s], elapsed, learned.truths, config.protocol)) {
      look_for_changes(learned.result.slam.scans, learned.maps.filtered, same_for_all, part);
      run_candidates(
          make_candidates(map_models, localize_one, job.peers, learned, same_for_all, part), part,
          comparison.parts.size(), job.seeds, pool, progress, comparison.models);
      predict_with_models(map_models, part, learned.maps, same_for_all, pool, comparison);
      comparison.parts.push_back(part.info);
    }
    if (s > 0) continue;
    outcome.learned = std::move(learned.result);
    outcome.maps = std::move(learned.maps);
  }
  return outcome;
}

}  // namespace strata::pipeline
