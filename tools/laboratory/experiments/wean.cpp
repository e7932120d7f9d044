// SPDX-License-Identifier: Apache-2.0
#include "tools/laboratory/experiments/wean.hpp"

#include <algorithm>

#include "core/localization/localizer.hpp"
#include "tools/laboratory/experiments/wean_doors.hpp"
#include "tools/pipeline/compare_config.hpp"
#include "tools/pipeline/localization_metrics.hpp"

namespace strata::experiments {
namespace {

constexpr double kNearDoor_m = 5.0;
constexpr double kOnLearnedWay_m = 2.0;

using pipeline::Poses;
using pipeline::ScanError;

/// The observations of some runs, by their places.
std::vector<std::size_t> places_of(const WeanRuns& wean, const std::vector<int>& runs) {
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < wean.runs.observations.size(); ++i) {
    const int run = wean.runs.observations[i].run;
    if (std::find(runs.begin(), runs.end(), run) != runs.end()) places.push_back(i);
  }
  return places;
}

bool is_near_door(const Pose2& pose) {
  return std::any_of(wean_doors().begin(), wean_doors().end(), [&](const WeanDoor& door) {
    const bool has_changed = door.differs(0, 1) || door.differs(0, 2) || door.differs(1, 2);
    return has_changed && (door.middle_m - pose.translation()).norm() < kNearDoor_m;
  });
}

bool is_on_way(const Pose2& pose, const Poses& way) {
  return std::any_of(way.begin(), way.end(), [&](const std::optional<Pose2>& other) {
    return other && (other->translation() - pose.translation()).norm() < kOnLearnedWay_m;
  });
}

/// Errors of the scans whose truth is known, one after the other.
class ErrorSum {
 public:
  void add(double error_m, bool near_door) {
    all_.push_back(error_m);
    if (near_door) near_doors_.push_back(error_m);
  }
  [[nodiscard]] WeanError mean() const {
    return {pipeline::summarize(all_).mean, pipeline::summarize(near_doors_).mean};
  }

 private:
  std::vector<double> all_;
  std::vector<double> near_doors_;
};

}  // namespace

WeanRuns read_wean_runs(const std::filesystem::path& folder, int threads) {
  pipeline::RunsInput input;
  for (const char* name : {"run1", "run2", "run3"}) {
    input.logs.push_back((folder / (std::string(name) + ".clf.gz")).string());
    input.poses.push_back((folder / (std::string(name) + ".ref.txt")).string());
  }
  WeanRuns wean;
  wean.runs = pipeline::read_runs(input, nullptr);
  const pipeline::LearnParts poses_only{.patch = false, .timescale = false};
  maps::LearnConfig config;
  config.slam.given_poses.stddev_m = kWeanCoherentStddev_m;
  pipeline::LearnResult all = pipeline::learn(wean.runs.observations, wean.runs.poses, config,
                                              poses_only, 1, threads, nullptr);
  wean.common = pipeline::poses_of(all.slam, wean.runs.observations);
  wean.scans = std::move(all.slam.scans);
  return wean;
}

WeanMaps learn_wean_maps(const WeanRuns& wean, const std::vector<int>& of, bool refined,
                         int threads, double stddev_m) {
  const std::vector<std::size_t> places = places_of(wean, of);
  const std::vector<Observation> observations = pipeline::pick(wean.runs.observations, places);
  maps::LearnConfig config;
  config.slam.given_poses.stddev_m = stddev_m;
  config.slam.given_poses.refine = refined;
  config.slam.given_poses.refine_alone = refined;
  const pipeline::LearnParts parts{.patch = true, .timescale = false};
  const pipeline::LearnResult result = pipeline::learn(
      observations, pipeline::pick(wean.runs.poses, places), config, parts, 1, threads, nullptr);
  const Poses learned = pipeline::poses_of(result.slam, observations);
  std::vector<Pose2> source;
  std::vector<Pose2> target;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (!learned[i] || !wean.common[places[i]]) continue;
    source.push_back(*wean.common[places[i]]);
    target.push_back(*learned[i]);
  }
  return {pipeline::maps_of(result, {}), align(source, target)};
}

WeanDoors judge_wean_doors(const patch::PatchMap& map, int run_a, int run_b) {
  WeanDoors doors;
  doors.of_submap.resize(map.submaps.size());
  for (std::size_t d = 0; d < wean_doors().size(); ++d) {
    const WeanDoor& door = wean_doors()[d];
    bool is_right = false;
    for (std::size_t s = 0; s < map.submaps.size(); ++s) {
      if (!covers(map.submaps[s], door)) continue;
      doors.of_submap[s].push_back(d);
      is_right = is_right || has_both_states(map.submaps[s], door, run_a, run_b);
    }
    if (door.differs(run_a, run_b)) doors.changed.push_back(d);
    if (is_right) doors.right.push_back(d);
  }
  doors.elsewhere = static_cast<std::size_t>(
      std::count_if(doors.of_submap.begin(), doors.of_submap.end(),
                    [](const std::vector<std::size_t>& covered) { return covered.empty(); }));
  return doors;
}

WeanOutcome localize_wean_run(const WeanRuns& wean, int run, const WeanMaps& learned,
                              const std::vector<int>& of, const std::string& model,
                              std::uint64_t seed, int threads) {
  const pipeline::CompareConfig config;
  const std::vector<std::size_t> places = places_of(wean, {run});
  const Poses way = pipeline::pick(wean.runs.poses, places_of(wean, of));
  const double m = config.protocol.start_stddev_m;
  const double rad = config.protocol.start_stddev_rad;
  localization::Localizer localizer(config.localizer,
                                    maps::make_map_model(learned.maps, model, config.sensor).sensor,
                                    seed, threads);
  localizer.set_free_space(learned.maps.filtered);
  localizer.initialize({wean.runs.poses[places.front()].value(),
                        Eigen::Vector3d(m * m, m * m, rad * rad).asDiagonal()});
  WeanOutcome outcome;
  ErrorSum reference;
  ErrorSum common;
  std::vector<ScanError> errors;
  for (const std::size_t i : places) {
    const Observation& observation = wean.runs.observations[i];
    const localization::LocalizationResult& result = localizer.update(observation);
    if (!wean.runs.poses[i]) continue;
    const Pose2& truth = *wean.runs.poses[i];
    const bool near_door = is_near_door(truth);
    const double error_m = localization::weighted_error(localizer.particles(), truth);
    errors.push_back({observation.scan.stamp, error_m, 0.0});
    reference.add(error_m, near_door);
    if (wean.common[i]) {
      const Pose2 aligned = learned.map_from_common * *wean.common[i];
      common.add(localization::weighted_error(localizer.particles(), aligned), near_door);
    }
    if (result.health.state == localization::HealthState::kLost) {
      ++(is_on_way(truth, way) ? outcome.lost_scans : outcome.lost_beyond_scans);
    }
  }
  outcome.reference = reference.mean();
  outcome.common = common.mean();
  const pipeline::LocalizationMetrics metrics = pipeline::evaluate_run(errors);
  outcome.failure_rate = metrics.failure_rate;
  outcome.is_lost = metrics.lost;
  return outcome;
}

}  // namespace strata::experiments
