// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/compare.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "core/base/error.hpp"
#include "core/base/parallel.hpp"
#include "tools/pipeline/localize.hpp"
#include "tools/pipeline/scan_prediction.hpp"

namespace strata::pipeline {
namespace {

using Poses = std::vector<std::optional<Pose2>>;

bool any_known(const Poses& poses) {
  return std::any_of(poses.begin(), poses.end(), [](const auto& pose) { return pose.has_value(); });
}

/// Poses of a SLAM result, one an observation; nothing for scans that it skipped.
Poses poses_of(const slam::SlamResult& result, std::span<const Observation> observations) {
  std::map<std::pair<int, std::int64_t>, Pose2> by_scan;
  for (const PosedScan& scan : result.scans) {
    by_scan[{scan.run, scan.scan.stamp.ns}] = scan.map_from_robot;
  }
  Poses poses;
  for (const Observation& observation : observations) {
    const auto found = by_scan.find({observation.run, observation.scan.stamp.ns});
    poses.push_back(found == by_scan.end() ? std::nullopt : std::optional(found->second));
  }
  return poses;
}

/// The trajectory that SLAM gives to the whole log at once.
Poses joint_trajectory(const Runs& runs, const CompareConfig& config, int threads,
                       Progress* progress) {
  LearnParts nothing_else{.patch = false, .timescale = false};
  const LearnResult all =
      learn(runs.observations, {}, config.learn, nothing_else, 1, threads, progress);
  return poses_of(all.slam, runs.observations);
}

/// map_from_truth, from the learning part.
Pose2 align_truth(const Runs& runs, const Poses& learned) {
  std::vector<Pose2> source;
  std::vector<Pose2> target;
  for (std::size_t i = 0; i < learned.size(); ++i) {
    if (!runs.truths[i] || !learned[i]) continue;
    source.push_back(*runs.truths[i]);
    target.push_back(*learned[i]);
  }
  if (source.empty()) {
    throw InputError("--truth", "has no pose in the learning part",
                     "check that it belongs to this log");
  }
  return align(source, target);
}

/// Traces of the first seed's states, by sub-map.
std::vector<StateTrace> traces_of(const std::vector<maps::StateRow>& rows, Stamp begin) {
  std::map<int, StateTrace> traces;
  for (const maps::StateRow& row : rows) {
    StateTrace& trace = traces[row.submap];
    trace.submap = row.submap;
    const auto configuration = static_cast<std::size_t>(row.configuration);
    if (trace.probability.size() <= configuration) trace.probability.resize(configuration + 1);
    if (configuration == 0) trace.time_s.push_back((row.stamp - begin).seconds());
    trace.probability[configuration].push_back(row.probability);
  }
  std::vector<StateTrace> result;
  for (auto& [submap, trace] : traces) result.push_back(std::move(trace));
  return result;
}

/// What is the same for every model.
struct TestPart {
  std::span<const Observation> observations;
  std::span<const std::optional<Pose2>> truths;
  Pose2Gaussian start;
};

TestPart make_test_part(const Runs& runs, std::size_t train_scans, const Poses& truths,
                        const CompareProtocol& protocol) {
  std::size_t first = train_scans;
  while (first < truths.size() && !truths[first]) ++first;
  if (first >= truths.size()) {
    throw InputError("test part", "has no scan with a known pose",
                     "choose another split with --train-until");
  }
  TestPart part{std::span(runs.observations).subspan(first), std::span(truths).subspan(first), {}};
  part.start.mean = *truths[first];
  const double m = protocol.start_stddev_m;
  const double rad = protocol.start_stddev_rad;
  part.start.covariance = Eigen::Vector3d(m * m, m * m, rad * rad).asDiagonal();
  return part;
}

ModelResult run_model(const maps::MapModel& model, const TestPart& part,
                      const ReflectionGrid& free_space, const CompareConfig& config,
                      const std::vector<std::uint64_t>& seeds, WorkerPool& pool) {
  ModelResult result;
  result.model = model.name;
  result.map_bytes = model.bytes;
  result.runs.resize(seeds.size());
  std::vector<maps::StateRow> states;
  // One run a thread: the runs do not depend on each other, nor on how many go at once.
  pool.for_chunks(seeds.size(), 1, [&](std::size_t s, std::size_t, std::size_t) {
    LocalizationRun run = localize(part.observations, part.truths, model, free_space,
                                   config.localizer, {part.start}, seeds[s], 1, nullptr);
    ModelRun& kept = result.runs[s];
    kept.seed = seeds[s];
    kept.metrics = evaluate_run(run.errors);
    kept.errors = std::move(run.errors);
    kept.update_ms = std::move(run.update_ms);
    if (s == 0) states = std::move(run.states);
  });
  result.states = traces_of(states, part.observations.front().scan.stamp);
  result.prediction = predict_scans(part.observations, part.truths, model, config.sensor.beam,
                                    config.protocol.prediction_every);
  return result;
}

}  // namespace

CompareOutcome compare(const Runs& runs, const std::string& log, const CompareConfig& config,
                       std::optional<double> train_until_s, const std::vector<std::uint64_t>& seeds,
                       int threads, Progress* progress) {
  const std::vector<double> elapsed = elapsed_seconds(runs.observations);
  const double until_s = train_until_s.value_or(config.protocol.train_share * elapsed.back());
  const auto split = std::upper_bound(elapsed.begin(), elapsed.end(), until_s);
  return compare_split(runs, static_cast<std::size_t>(split - elapsed.begin()), log, config, seeds,
                       threads, progress);
}

CompareOutcome compare_split(const Runs& runs, std::size_t train_scans, const std::string& log,
                             const CompareConfig& config, const std::vector<std::uint64_t>& seeds,
                             int threads, Progress* progress) {
  require_valid(config, "compare");
  if (train_scans == 0 || train_scans >= runs.observations.size()) {
    throw InputError(log, "leaves nothing to learn from or nothing to test on",
                     "choose another split with --train-until");
  }
  const std::vector<Observation> train(
      runs.observations.begin(),
      runs.observations.begin() + static_cast<std::ptrdiff_t>(train_scans));
  const bool has_truth = any_known(runs.truths);
  const bool has_poses = any_known(runs.poses);
  Poses truths = runs.poses;
  if (!has_truth && !has_poses) truths = joint_trajectory(runs, config, threads, progress);

  CompareOutcome outcome;
  Poses given(truths.begin(), truths.begin() + static_cast<std::ptrdiff_t>(train_scans));
  outcome.learned = learn(train, given, config.learn, {}, seeds.front(), threads, progress);
  if (has_truth) {
    const Pose2 map_from_truth = align_truth(runs, poses_of(outcome.learned.slam, train));
    truths = runs.truths;
    for (auto& truth : truths) {
      if (truth) truth = map_from_truth * *truth;
    }
    outcome.maps.map_from_truth = map_from_truth;
  }
  outcome.maps.occupancy = outcome.learned.slam.occupancy;
  outcome.maps.filtered = outcome.learned.slam.filtered;
  outcome.maps.patches = outcome.learned.patches;
  outcome.maps.timescale = outcome.learned.timescale;

  const TestPart part = make_test_part(runs, train_scans, truths, config.protocol);
  localization::PatchBeamModelConfig sensor = config.sensor;
  if (sensor.beam.beams.max_range_m == 0.0) {
    // The same reach for all: timescale nodes know nothing beyond theirs.
    sensor.beam.beams.max_range_m = config.learn.timescale.max_range_m;
  }
  CompareConfig same_for_all = config;
  same_for_all.sensor = sensor;
  const std::vector<double> elapsed = elapsed_seconds(runs.observations);
  Comparison& comparison = outcome.comparison;
  comparison.log = log;
  comparison.train_s = {0.0, elapsed[train_scans - 1]};
  comparison.test_s = {elapsed[train_scans], elapsed.back()};
  comparison.truth = has_truth || has_poses ? TruthKind::kGiven : TruthKind::kJointTrajectory;
  WorkerPool pool(threads);
  const auto& models = config.protocol.models;
  for (std::size_t m = 0; m < models.size(); ++m) {
    const maps::MapModel model = maps::make_map_model(outcome.maps, models[m], sensor);
    comparison.models.push_back(
        run_model(model, part, outcome.maps.filtered, same_for_all, seeds, pool));
    report_progress(progress, "localize with every model", m + 1, models.size());
  }
  return outcome;
}

}  // namespace strata::pipeline
