// SPDX-License-Identifier: Apache-2.0
#include "tools/pipeline/scan_prediction.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

#include "core/rays/scan_beams.hpp"
#include "tools/pipeline/known_pose_predictor.hpp"
#include "tools/statistics/statistics.hpp"

namespace strata::pipeline {
namespace {

using rays::ScanBeams;

constexpr std::size_t kRecallScans = 10;

/// Sums of a ScanPrediction.
class Fit {
 public:
  void add(const KnownPosePredictor::Likelihood& likelihood) {
    nats_ += likelihood.nats;
    beams_ += likelihood.beams;
  }
  void add_deviations(const ScanBeams& beams, const Pose2& map_from_robot,
                      const maps::RangeFunction& expected_range) {
    const Pose2 laser = map_from_robot * beams.robot_from_laser;
    for (std::size_t k = 0; k < beams.size(); ++k) {
      if (beams.is_hit[k] == 0) continue;
      const double expected_m =
          std::min(expected_range(laser, beams.bearing_rad[k]), beams.r_max_m);
      deviations_.push_back(std::abs(beams.range_m[k] - expected_m));
    }
  }
  [[nodiscard]] ScanPrediction result() {
    if (beams_ == 0 || deviations_.empty()) return {};
    return {nats_ / static_cast<double>(beams_), statistics::median(std::move(deviations_)),
            beams_};
  }

 private:
  double nats_ = 0.0;
  std::size_t beams_ = 0;
  std::vector<double> deviations_;
};

/// The scan with all beams but these turned invalid: sensor models choose among what is left.
Scan only_beams(const Scan& scan, const std::vector<std::uint32_t>& beams) {
  Scan result = scan;
  std::fill(result.ranges_m.begin(), result.ranges_m.end(),
            std::numeric_limits<float>::quiet_NaN());
  for (const std::uint32_t beam : beams) result.ranges_m[beam] = scan.ranges_m[beam];
  return result;
}

/// The scan without the beams that a localizer would choose of it, but moved by half a step: as
/// many others.
Scan without_chosen_beams(const Scan& scan, const rays::BeamSelectionConfig& config) {
  const double step_rad = std::abs(static_cast<double>(scan.angle_increment_rad));
  const auto every = static_cast<std::size_t>(
      std::max(1.0, std::ceil(config.min_angle_rad / std::max(step_rad, 1e-9) - 0.01)));
  Scan result = scan;
  const std::size_t shift = every / 2;
  if (shift == 0) return only_beams(scan, {});  // the localizer looks at every beam
  result.ranges_m.erase(result.ranges_m.begin(),
                        result.ranges_m.begin() +
                            static_cast<std::ptrdiff_t>(std::min(shift, result.ranges_m.size())));
  result.angle_min_rad += static_cast<float>(shift) * scan.angle_increment_rad;
  return result;
}

/// Fit per beam of a scan in the map as it was.
double oracle_fit(const ChangeEvent& event, const Scan& scan, const Pose2& map_from_robot,
                  const localization::BeamModelConfig& config) {
  const localization::GridBeamModel oracle(event.oracle, config);
  localization::ParticleSet robot;
  robot.resize(1);
  robot.set_pose(0, map_from_robot);
  double nats = 0.0;
  WorkerPool pool(1);
  const std::size_t beams = oracle.log_likelihoods(scan, {1.0}, robot, std::span(&nats, 1), pool);
  return beams == 0 ? 0.0 : nats / static_cast<double>(beams);
}

/// Sums of the recall of each event, and the belief at its end.
class Recall {
 public:
  Recall(const TestScans& test, const maps::MapModel& model,
         const localization::BeamModelConfig& config, std::size_t events)
      : test_(test), model_(model), config_(config), sums_(events, 0.0), counts_(events, 0) {}

  void see(std::size_t scan, const KnownPosePredictor& predictor, EventFollower& follower) {
    const Scan& seen = test_.observations[scan].scan;
    for (const auto& [e, v] : follower.views_of(scan)) {
      const ChangeEvent& event = test_.changes->events[e];
      if (!event.is_old_state || v >= kRecallScans) continue;
      const KnownPosePredictor::Likelihood likelihood = predictor.likelihood(seen);
      if (likelihood.beams == 0) continue;
      sums_[e] += likelihood.nats / static_cast<double>(likelihood.beams) -
                  oracle_fit(event, seen, *test_.truths[scan], config_);
      ++counts_[e];
      follower.outcome(e).recall = sums_[e] / static_cast<double>(counts_[e]);
    }
  }
  void learned(std::size_t scan, const KnownPosePredictor& predictor,
               EventFollower& follower) const {
    const localization::PatchStates* states = model_.sensor->patch_states();
    if (states == nullptr) return;
    for (const auto& [e, v] : follower.views_of(scan)) {
      const ChangeEvent& event = test_.changes->events[e];
      if (!event.is_old_state || v >= kRecallScans) continue;
      const auto belief = belief_in_state(event, states->map(), predictor.beliefs());
      if (belief) follower.outcome(e).true_state_probability = belief;
    }
  }

 private:
  const TestScans& test_;
  const maps::MapModel& model_;
  const localization::BeamModelConfig& config_;
  std::vector<double> sums_;
  std::vector<std::size_t> counts_;
};

}  // namespace

PredictionScore score_predictions(const TestScans& test, const maps::MapModel& model,
                                  const localization::BeamModelConfig& config,
                                  const PredictionChoice& choice) {
  KnownPosePredictor predictor(model);
  EventFollower follower(test, config.beams.max_range_m);
  Recall recall(test, model, config, test.changes ? test.changes->events.size() : 0);
  Fit overall;
  Fit changed;
  PredictionScore score;
  using Clock = std::chrono::steady_clock;
  for (std::size_t i = 0; i < test.observations.size(); ++i) {
    if (!test.truths[i]) continue;
    const Scan& scan = test.observations[i].scan;
    predictor.go_to(*test.truths[i], scan.stamp);
    const bool is_due = i % static_cast<std::size_t>(choice.every) == 0;
    const bool sees_change = test.changes != nullptr && test.changes->sees_change(i);
    if (is_due || sees_change || !follower.views_of(i).empty()) {
      const auto begin = Clock::now();
      const maps::RangeFunction expected_range = predictor.expected_range();
      if (is_due) {
        const Scan judged = choice.unseen_beams ? without_chosen_beams(scan, config.beams) : scan;
        overall.add_deviations(rays::select_beams(judged, config.beams), *test.truths[i],
                               expected_range);
        const std::chrono::duration<double, std::milli> took = Clock::now() - begin;
        score.query_ms.push_back(took.count());
        const KnownPosePredictor::Likelihood fit = predictor.likelihood(judged);
        overall.add(fit);
        score.series.push_back(
            {(scan.stamp - test.observations.front().scan.stamp).seconds(), fit.nats, fit.beams});
      }
      if (sees_change) {
        const Scan reaching = only_beams(scan, test.changes->place_beams[i]);
        changed.add(predictor.likelihood(reaching));
        changed.add_deviations(rays::select_beams(reaching, config.beams), *test.truths[i],
                               expected_range);
      }
      follower.see(i, expected_range);
      recall.see(i, predictor, follower);
    }
    predictor.learn(scan);
    recall.learned(i, predictor, follower);
  }
  score.overall = overall.result();
  score.changed = changed.result();
  score.events = follower.take();
  return score;
}

std::vector<EventOutcome> follow_memory(const TestScans& test, const maps::Maps& maps,
                                        const maps::MapModel& model,
                                        const patch_beams::PatchBeamModelConfig& sensor) {
  // A copy that goes on learning.
  auto live = std::make_shared<memory::TimescaleMemory>(*maps.timescale);
  maps::Maps now;
  now.timescale = live;
  now.decoding = maps.decoding;
  now.timescale_use = maps.timescale_use;
  now.filtered = maps.filtered;
  now.filtered_caster = maps.filtered_caster;
  EventFollower follower(test, sensor.beam.beams.max_range_m);
  for (std::size_t i = 0; i < test.observations.size(); ++i) {
    if (!test.truths[i]) continue;
    const Observation& observation = test.observations[i];
    if (!follower.views_of(i).empty()) {
      now.nodes = live->decode(now.decoding, now.nodes.get());
      follower.see(i, maps::make_map_model(now, model, sensor).best_prediction({}));
    }
    live->observe({observation.run, observation.scan, *test.truths[i], {}});
  }
  return follower.take();
}

}  // namespace strata::pipeline
