// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/model_scores.hpp"

#include <algorithm>
#include <functional>
#include <string>
#include <utility>

#include "tools/pipeline/online_predictor.hpp"
#include "tools/pipeline/scan_prediction.hpp"

namespace strata::pipeline {
namespace {

/// The timescale memory goes on learning for adaptation, as it would on the robot; grids are what
/// they are, and patch models follow by beliefs.
void follow_with_memory(const maps::MapModel& model, const TestScans& test, const maps::Maps& maps,
                        const CompareConfig& config, PredictionScore& score) {
  if (model.descriptor->learns != maps::MapLearning::kMemory) return;
  if (test.changes->events.empty()) return;
  const auto followed = follow_memory(test, maps, model, config.sensor);
  for (std::size_t e = 0; e < score.events.size(); ++e) {
    score.events[e].adapted_after_scans = followed[e].adapted_after_scans;
    score.events[e].adapted_after_s = followed[e].adapted_after_s;
    score.events[e].mixed_share = followed[e].mixed_share;
  }
}

/// Beams that no localizer looks at, from where the runs of the first seeds believed to be.
ScanPrediction predict_from_own_poses(const maps::MapModel& model, const ModelResult& result,
                                      const TestPart& part, std::size_t part_index,
                                      const CompareConfig& config) {
  ModelResult own;
  for (const ModelRun& run : result.runs) {
    if (run.part != part_index || own.scores.size() >= kOwnPoseSeeds) continue;
    if (run.estimates.size() != part.observations.size()) continue;  // scans were lost on the way
    const std::vector<std::optional<Pose2>> poses(run.estimates.begin(), run.estimates.end());
    own.scores.push_back(score_predictions({part.observations, poses, nullptr}, model,
                                           config.sensor.beam,
                                           {config.protocol.prediction_every, true}));
  }
  return pool_predictions(own, &PredictionScore::overall);
}

/// What is found out about one model in one part.
struct Scores {
  PredictionScore prediction;
  FalseAdaptation false_adaptation;
  PlanningScore planning;
  ScanPrediction own_pose;
};

}  // namespace

void score_models(const std::vector<maps::MapModel>& models, const TestPart& part,
                  std::size_t part_index, const maps::Maps& maps, const CompareConfig& config,
                  WorkerPool& pool, std::vector<ModelResult>& results) {
  const TestScans test{part.observations, part.truths, &part.changes};
  const double r_max_m = config.sensor.beam.beams.max_range_m;
  const std::vector<Transient> transients = place_transients(test, r_max_m);
  const std::vector<PlanningTask> tasks = planning_tasks(test);
  const ReflectionGrid found = map_of_drive(test, maps.filtered.resolution_m());
  std::vector<Scores> scores(models.size());
  const auto predict = [&](std::size_t m) {
    scores[m].prediction =
        score_predictions(test, models[m], config.sensor.beam, {config.protocol.prediction_every});
    follow_with_memory(models[m], test, maps, config, scores[m].prediction);
  };
  const auto be_fooled = [&](std::size_t m) {
    const auto undisturbed = make_online_predictor(maps, models[m], config.sensor);
    const auto disturbed = make_online_predictor(maps, models[m], config.sensor);
    scores[m].false_adaptation =
        follow_transients(test, transients, r_max_m, *undisturbed, *disturbed);
  };
  const auto plan = [&](std::size_t m) {
    const auto watcher = make_online_predictor(maps, models[m], config.sensor);
    scores[m].planning = judge_planning(test, tasks, found, *watcher);
  };
  const auto predict_own = [&](std::size_t m) {
    scores[m].own_pose = predict_from_own_poses(models[m], results[m], part, part_index, config);
  };
  // The longest first, of all models: what comes last must not keep one worker busy alone.
  const std::vector<std::function<void(std::size_t)>> jobs{plan, be_fooled, predict, predict_own};
  pool.for_chunks(jobs.size() * models.size(), 1,
                  [&](std::size_t i, std::size_t /*end*/, std::size_t /*chunk*/) {
                    jobs[i / models.size()](i % models.size());
                  });
  for (std::size_t m = 0; m < models.size(); ++m) {
    results[m].scores.push_back(std::move(scores[m].prediction));
    results[m].false_adaptation.push_back(scores[m].false_adaptation);
    results[m].planning.push_back(scores[m].planning);
    results[m].own_pose.push_back(scores[m].own_pose);
  }
}

}  // namespace strata::pipeline
