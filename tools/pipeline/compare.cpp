// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/compare.hpp"

#include <algorithm>
#include <iterator>
#include <map>
#include <mutex>
#include <utility>

#include "core/base/error.hpp"
#include "core/base/parallel.hpp"
#include "tools/pipeline/scan_prediction.hpp"
#include "tools/pipeline/test_part.hpp"

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

/// map_from_truth, from the learning part; one entry a learned observation.
Pose2 align_truth(const Poses& truths, const Poses& learned) {
  std::vector<Pose2> source;
  std::vector<Pose2> target;
  for (std::size_t i = 0; i < learned.size(); ++i) {
    if (!truths[i] || !learned[i]) continue;
    source.push_back(*truths[i]);
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

/// Maps of one split, and the truth in their frame.
struct Learned {
  LearnResult result;
  maps::Maps maps;
  Poses truths;  ///< map_from_robot, one an observation of the runs
};

Learned learn_split(const Runs& runs, const Split& split, const Poses& poses,
                    const CompareConfig& config, const CompareJob& job) {
  Learned learned;
  const std::vector<Observation> train = learning_part(runs, split);
  learned.result = learn(train, pick(poses, split.train), config.learn, {}, job.seeds.front(),
                         job.threads, job.progress);
  learned.truths = poses;
  maps::Maps& maps = learned.maps;
  maps.given = job.given_map;
  if (any_known(runs.truths)) {
    const Pose2 map_from_truth =
        align_truth(pick(runs.truths, split.train), poses_of(learned.result.slam, train));
    learned.truths = runs.truths;
    for (auto& truth : learned.truths) {
      if (truth) truth = map_from_truth * *truth;
    }
    maps.map_from_truth = map_from_truth;
    maps.given_from_map = inverse(map_from_truth);
  }
  maps.occupancy = learned.result.slam.occupancy;
  maps.filtered = learned.result.slam.filtered;
  maps.patches = learned.result.patches;
  maps.timescale = learned.result.timescale;
  if (maps.timescale) maps.nodes = maps.timescale->decode();
  return learned;
}

/// Progress that several threads report to.
class SharedProgress {
 public:
  SharedProgress(Progress* progress, std::size_t total) : progress_(progress), total_(total) {}
  void one_done() {
    const std::lock_guard lock(mutex_);
    report_progress(progress_, "localize with every model", ++done_, total_);
  }

 private:
  Progress* progress_;
  std::size_t total_;
  std::mutex mutex_;
  std::size_t done_ = 0;
};

LocalizationRun localize_here(const LocalizeJob& job) {
  return localize(job.observations, job.truths, job.model, job.free_space, job.config, {job.start},
                  job.seed, 1, nullptr);
}

/// Whoever localizes: one of our models or a peer.
struct Candidate {
  std::size_t map_bytes = 0;
  std::function<LocalizationRun(std::uint64_t seed)> localize;
};

std::vector<Candidate> make_candidates(const std::vector<maps::MapModel>& models,
                                       const LocalizeFunction& localize_one,
                                       const std::vector<Peer>& peers, const Learned& learned,
                                       const CompareConfig& config, const TestPart& part) {
  std::vector<Candidate> candidates;
  for (const maps::MapModel& model : models) {
    candidates.push_back({model.bytes, [&](std::uint64_t seed) {
                            return localize_one({part.observations, part.truths, model,
                                                 learned.maps.filtered, config.localizer,
                                                 part.start, seed});
                          }});
  }
  for (const Peer& peer : peers) {
    const ReflectionGrid& map = learned.maps.occupancy;
    candidates.push_back({map.size() * sizeof(float), [&](std::uint64_t seed) {
                            return peer.localize(
                                {part.observations, part.truths, models.front(),
                                 learned.maps.filtered, config.localizer, part.start, seed},
                                map);
                          }});
  }
  return candidates;
}

/// Every seed of every candidate in one part. One run a thread: the runs depend neither on each
/// other nor on how many go at once.
void run_candidates(const std::vector<Candidate>& candidates, const TestPart& part,
                    std::size_t part_index, const std::vector<std::uint64_t>& seeds,
                    WorkerPool& pool, SharedProgress& progress, Comparison& comparison) {
  std::vector<ModelRun> runs(candidates.size() * seeds.size());
  std::vector<std::vector<maps::StateRow>> states(candidates.size());
  pool.for_chunks(runs.size(), 1, [&](std::size_t i, std::size_t, std::size_t) {
    const std::size_t c = i / seeds.size();
    LocalizationRun run = candidates[c].localize(seeds[i % seeds.size()]);
    ModelRun& kept = runs[i];
    kept.part = part_index;
    kept.seed = seeds[i % seeds.size()];
    kept.metrics = evaluate_run(run.errors);
    kept.errors = std::move(run.errors);
    kept.update_ms = std::move(run.update_ms);
    for (const log::StampedPose& pose : run.trajectory) {
      kept.estimates_m.push_back(pose.pose.translation());
    }
    judge_changed_places(part, kept);
    if (i % seeds.size() == 0) states[c] = std::move(run.states);
    progress.one_done();
  });
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    ModelResult& result = comparison.models[c];
    if (part_index == 0) {
      result.map_bytes = candidates[c].map_bytes;
      result.states = traces_of(states[c], part.observations.front().scan.stamp);
    }
    const auto first = runs.begin() + static_cast<std::ptrdiff_t>(c * seeds.size());
    std::move(first, first + static_cast<std::ptrdiff_t>(seeds.size()),
              std::back_inserter(result.runs));
  }
}

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
          comparison.parts.size(), job.seeds, pool, progress, comparison);
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
