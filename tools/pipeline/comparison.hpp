// SPDX-License-Identifier: Apache-2.0
/// The outcome of comparing map models on one log: who localizes better, and is it more than
/// chance.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "tools/pipeline/localization_metrics.hpp"
#include "tools/pipeline/planning.hpp"
#include "tools/pipeline/scan_prediction.hpp"
#include "tools/pipeline/transients.hpp"
#include "tools/statistics/statistics.hpp"

namespace strata::pipeline {

/// Where the poses that errors are measured against come from.
enum class TruthKind { kGiven, kJointTrajectory };

/// One model with one seed in one test part: the unit of all statistics.
struct ModelRun {
  std::size_t part = 0;  ///< place in Comparison::parts
  std::uint64_t seed = 0;
  std::vector<ScanError> errors;
  std::vector<std::uint8_t> sees_change;  ///< one an error: 1 where it changed
  std::vector<Pose2> estimates;           ///< of the particles, one a scan, map frame
  std::vector<float> shown_particles;     ///< LocalizationRun's, of a part's first run; not saved
  std::vector<double> update_ms;
  LocalizationMetrics metrics;
  /// Over the scans that see a place that changed; nothing when there are none.
  std::optional<double> changed_error_m;
  std::optional<double> changed_failure_rate;
  /// Over the scans that show a change back to an old state, and to one never seen before.
  std::optional<double> old_state_error_m;
  std::optional<double> new_state_error_m;
};

/// P(configuration | data) of one sub-map over the test part.
struct StateTrace {
  int submap = 0;
  std::vector<double> time_s;
  std::vector<std::vector<double>> probability;  ///< per configuration, one entry a time
};

/// A model learned in some memory, over all drives.
struct MemoryPoint {
  std::string setting;
  std::size_t bytes = 0;            ///< as stored, of the first split
  std::vector<double> run_means_m;  ///< one a drive and seed
  std::size_t lost_runs = 0;
};

struct ModelResult {
  std::string model;
  std::size_t map_bytes = 0;            ///< of the first split, as stored
  std::size_t resident_bytes = 0;       ///< ... in memory
  std::vector<PredictionScore> scores;  ///< one a part
  std::vector<ModelRun> runs;           ///< part by part, seeds in order, the same for every model
  std::vector<StateTrace> states;       ///< of the first part and seed; patch models only
  std::vector<MemoryPoint> memory;      ///< from full memory on downwards; empty: not tried
  std::vector<FalseAdaptation> false_adaptation;  ///< one a part; empty for peers, like the rest
  std::vector<PlanningScore> planning;
  std::vector<ScanPrediction> own_pose;  ///< unseen beams from the runs' own poses
};

/// A change that the robot met, for the figure of errors over time and the table of events.
struct MetChange {
  double time_s = 0.0;  ///< since the part began, when the change was first seen
  Eigen::Vector2d center_m;
  std::size_t scans = 0;
  bool is_old_state = false;
  double appeared_share = 0.0;
};

/// One drive that was localized in: maps that did not learn from it.
struct TestPartInfo {
  std::string name;
  std::array<double, 2> train_s{};  ///< seconds from the start of the log
  std::array<double, 2> test_s{};
  std::size_t scans = 0;
  std::size_t changed_scans = 0;   ///< that see a place that changed
  std::size_t unmapped_scans = 0;  ///< taken where the maps know nothing: no map can help there
  std::vector<MetChange> changes;
};

struct Comparison {
  std::string log;
  std::string via = "direct";  ///< how the localizer was called: "direct" or "dds"
  std::size_t seeds = 0;
  TruthKind truth = TruthKind::kGiven;
  std::vector<TestPartInfo> parts;
  std::vector<ModelResult> models;
};

/// A model against another, paired over the units (part, seed).
struct PairedTest {
  std::string better;
  std::string worse;
  double mean_difference_m = 0.0;  ///< worse minus better
  double median_difference_m = 0.0;
  statistics::Interval ci95_m;  ///< of the mean difference
  double p = 1.0;               ///< Wilcoxon, Holm-adjusted over all pairs
  double cliffs_delta = 0.0;    ///< of the errors, worse against better
  bool significant = false;
  /// Units in which only one of the two was lost, and McNemar's p, Holm-adjusted over all pairs.
  std::size_t lost_only_better = 0;
  std::size_t lost_only_worse = 0;
  double p_lost = 1.0;
};

/// Every pair of models; differences that the interval and the test both support are significant.
[[nodiscard]] std::vector<PairedTest> paired_tests(const Comparison& comparison);

/// One sentence: which model localizes best here, or that there is no difference.
[[nodiscard]] std::string verdict(const Comparison& comparison,
                                  const std::vector<PairedTest>& tests);

/// comparison.json of the contracts.
[[nodiscard]] nlohmann::json to_json(const Comparison& comparison,
                                     const std::vector<PairedTest>& tests);

/// Mean over units of each run's mean error.
[[nodiscard]] double mean_error_m(const ModelResult& model);
/// Mean over units of the failure rate.
[[nodiscard]] double mean_failure_rate(const ModelResult& model);

/// How far the seeds' estimates lie from their mean at the same scan, over all scans and drives
/// [m]: what can be said without any truth. Nothing with one seed.
[[nodiscard]] std::optional<double> seed_spread_m(const ModelResult& model);

/// What a model did with all changes of all parts.
struct AdaptationSummary {
  std::size_t events = 0;
  std::size_t adapted = 0;
  /// Medians over the events, where one that was never adapted to is the longest; nothing when that
  /// is the median.
  std::optional<double> scans;
  std::optional<double> s;
  std::size_t old_states = 0;
  std::optional<double> recall_old_state;        ///< mean over the old states that came back
  std::optional<double> true_state_probability;  ///< likewise
  std::optional<double> mixed_share;             ///< mean over the events
};
[[nodiscard]] AdaptationSummary summarize_adaptation(const ModelResult& model);

/// Of the runs that were lost: how many found back, and the median of the seconds it took, where
/// never is the longest.
struct RecoverySummary {
  std::size_t lost = 0;
  std::size_t recovered = 0;
  std::optional<double> s;
};
[[nodiscard]] RecoverySummary summarize_recovery(const ModelResult& model);

/// Share of the beams predicted right that a transient obstacle makes wrong, over all parts;
/// nothing when none could be placed.
[[nodiscard]] std::optional<double> false_adaptation_share(const ModelResult& model);

/// All parts together; variations and distances as the mean over the parts that have them.
[[nodiscard]] PlanningScore pool_planning(const ModelResult& model);

/// 95% interval of log p per beam within the drives, by blocks of 30 s in time; nothing when all
/// scans together last less than two of them. With another model: of the difference.
[[nodiscard]] std::optional<statistics::Interval> fit_interval(const ModelResult& model,
                                                               const ModelResult* minus = nullptr);

/// All parts together, of own_pose.
[[nodiscard]] ScanPrediction pool_own_pose(const ModelResult& model);

/// All parts together: beams weigh the same, the median is that of the parts' medians.
[[nodiscard]] ScanPrediction pool_predictions(const ModelResult& model,
                                              ScanPrediction PredictionScore::*which);

}  // namespace strata::pipeline
