// SPDX-License-Identifier: Apache-2.0
#include "core/slam/slam.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/base/parallel.hpp"
#include "core/slam/em_loop.hpp"
#include "core/slam/log_checks.hpp"
#include "core/slam/submap_graph.hpp"
#include "core/slam/tracker.hpp"

namespace strata::slam {
namespace {

/// Fewer dynamic beams than this do not bend a trajectory.
constexpr double kWorthTrackingAgain = 0.003;

/// Rounds of EM before that: enough to tell which beams are dynamic.
constexpr int kRoundsBefore = 3;

/// How far a sub-map of scans that are placed may give way: hardly.
constexpr double kPlacedStddevM = 0.005;
constexpr double kPlacedStddevRad = 0.001;

/// A run in which no scan hit anything has none.
constexpr std::size_t kNoSubmap = std::numeric_limits<std::size_t>::max();

/// One accepted scan and what is known of its pose.
struct Record {
  PosedScan posed;
  Pose2 run_from_robot;
  std::optional<Pose2> odometry;
  std::optional<Pose2> given;
  bool placed = false;  // given by an earlier job, and final
  bool key = false;
  bool used = false;  // its scan is in the result
  std::size_t submap = kNoSubmap;
};

}  // namespace

struct Slam::State {
  State(const SlamConfig& slam_config, int threads)
      : config(slam_config),
        pool(threads),
        graph(slam_config.closure, slam_config.tracking.match, slam_config.tracking.field,
              slam_config.beam_filter.resolution_m, pool) {}

  SlamConfig config;
  WorkerPool pool;
  SubmapGraph graph;
  std::optional<Tracker> tracker;
  std::vector<Record> records;
  int run = 0;
  int runs = 0;
  std::vector<bool> mapped;   // of the scans in the result
  std::vector<bool> moves;    // those that do not keep the pose they came with
  bool run_is_given = false;  // the run's frame is that of its given poses
  Stamp last_stamp;
  LogChecks checks;
  std::vector<std::size_t> run_begins;
  Pose2 map_from_run;  // as the newest sub-map of the run has it

  Pose2Gaussian add(const Observation& observation, const Pose2* given_pose, bool placed,
                    std::span<const float> static_probability = {});
  /// The map of all that was added, after so many rounds of EM at most.
  [[nodiscard]] SlamResult finish(int rounds, Progress* progress);
  /// Rounds of EM from the poses as they are.
  void improve(SlamResult& result, int rounds, Progress* progress);
  void track_again(SlamResult& before, State& again);
  void start_run(const Observation& observation, const Pose2* given_pose);
  void end_run();
  void take_submaps();
  void place_scans();
  [[nodiscard]] std::optional<Pose2Gaussian> given_submap(const Submap& submap) const;
  /// A given pose, or one that an earlier job placed, as far as it is believed.
  [[nodiscard]] Pose2Gaussian believed(const Pose2& given, bool placed) const;
  /// Without any sub-map the first run's frame is the map's: odometry is better than nothing.
  [[nodiscard]] bool located(const Record& record) const {
    if (record.submap != kNoSubmap) return graph.located(record.submap);
    return graph.size() == 0 && record.posed.run == records.front().posed.run;
  }
  /// Whether the scan keeps the pose it came with.
  [[nodiscard]] bool stays(const Record& record) const {
    const bool keep_given = runs <= 1 || !config.given_poses.refine;
    return record.given && (record.placed || keep_given);
  }
};

void Slam::State::start_run(const Observation& observation, const Pose2* given_pose) {
  end_run();
  run = observation.run;
  ++runs;
  run_begins.push_back(records.size());
  run_is_given = given_pose != nullptr;
  Pose2 start;
  if (given_pose != nullptr) {
    start = *given_pose;
  } else if (observation.has_odometry) {
    // The map frame is the odometry frame at the first scan of the first run.
    start = observation.odom_from_robot;
  }
  map_from_run = {};
  tracker.emplace(config.tracking, config.beam_filter.resolution_m, run, start);
}

void Slam::State::end_run() {
  if (!tracker) return;
  tracker->finish(records.size());
  take_submaps();
  graph.end_run();
  tracker.reset();
}

Pose2Gaussian Slam::State::believed(const Pose2& given, bool placed) const {
  const double sigma_m = placed ? kPlacedStddevM : config.given_poses.stddev_m;
  const double sigma_rad = placed ? kPlacedStddevRad : config.given_poses.stddev_rad;
  Pose2Gaussian result{given, Eigen::Matrix3d::Zero()};
  result.covariance.diagonal() << sigma_m * sigma_m, sigma_m * sigma_m, sigma_rad * sigma_rad;
  return result;
}

std::optional<Pose2Gaussian> Slam::State::given_submap(const Submap& submap) const {
  std::vector<Pose2> tracked;
  std::vector<Pose2> given;
  for (std::size_t i = submap.first_scan; i < submap.last_scan; ++i) {
    if (!records[i].given) continue;
    tracked.push_back(records[i].run_from_robot);
    given.push_back(*records[i].given);
  }
  if (given.empty()) return std::nullopt;
  // The run's drifting frame is laid on the given poses as a rigid whole, heading included: the
  // positions of a short piece say little about its heading.
  std::vector<Pose2> corrections;
  for (std::size_t i = 0; i < given.size(); ++i) {
    corrections.push_back(given[i] * inverse(tracked[i]) * submap.run_from_submap);
  }
  const std::vector<double> weights(corrections.size(), 1.0);
  return believed(weighted_gaussian(corrections, weights).mean, records[submap.first_scan].placed);
}

void Slam::State::take_submaps() {
  for (Submap& submap : tracker->take_finished()) {
    const std::optional<Pose2Gaussian> given = given_submap(submap);
    const std::size_t first = submap.first_scan;
    const std::size_t last = submap.last_scan;
    const std::size_t index = graph.add(std::move(submap), given);
    for (std::size_t i = first; i < last; ++i) records[i].submap = index;
    map_from_run = graph.map_from_run(index);
  }
}

Slam::Slam(const SlamConfig& config, int threads) {
  require_valid(config, "slam");
  state_ = std::make_unique<State>(config, threads);
}

Slam::~Slam() = default;

std::size_t Slam::skipped_scans() const { return state_->checks.skipped(); }

Pose2Gaussian Slam::add(const Observation& observation, const Pose2* given_pose) {
  return state_->add(observation, given_pose, false);
}

void Slam::add_placed(const PosedScan& posed) {
  const Observation observation{posed.run, posed.scan, {}, false};
  state_->add(observation, &posed.map_from_robot, true);
}

Pose2Gaussian Slam::State::add(const Observation& observation, const Pose2* given_pose, bool placed,
                               std::span<const float> static_probability) {
  const bool new_run = !tracker || observation.run != run;
  std::optional<LogChecks::Skip> skip = LogChecks::reason_to_skip(observation, given_pose);
  if (!new_run && !records.empty()) {
    const Scan& last = records.back().posed.scan;
    if (observation.scan.stamp < last_stamp) skip = LogChecks::Skip::kOutOfOrder;
    if (observation.scan.stamp == last.stamp && observation.scan.ranges_m == last.ranges_m) {
      skip = LogChecks::Skip::kRepeated;
    }
  }
  if (skip) {
    checks.skip(*skip);
    if (records.empty()) return {};
    return {records.back().posed.map_from_robot, Eigen::Matrix3d::Identity()};
  }
  if (new_run) start_run(observation, given_pose);
  last_stamp = observation.scan.stamp;
  const Pose2* step = observation.has_odometry ? &observation.odom_from_robot : given_pose;
  const Pose2Gaussian given =
      given_pose != nullptr ? believed(*given_pose, placed) : Pose2Gaussian{};
  const TrackedScan tracked =
      tracker->add(observation.scan, step, records.size(),
                   run_is_given && given_pose != nullptr ? &given : nullptr, static_probability);
  checks.add(observation.scan, new_run, tracked.findings);
  Record record;
  record.posed.run = observation.run;
  record.posed.scan = observation.scan;
  record.run_from_robot = tracked.run_from_robot.mean;
  record.key = tracked.key;
  if (observation.has_odometry) record.odometry = observation.odom_from_robot;
  if (given_pose != nullptr) record.given = *given_pose;
  record.placed = placed;
  const Pose2Gaussian result =
      given_pose != nullptr
          ? given
          : Pose2Gaussian{map_from_run, Eigen::Matrix3d::Zero()} * tracked.run_from_robot;
  record.posed.map_from_robot = result.mean;
  records.push_back(std::move(record));
  take_submaps();
  return result;
}

/// Each scan goes with its sub-map; between the middles of two sub-maps of a run the correction
/// passes over smoothly, so that the trajectory does not jump where one takes over.
void Slam::State::place_scans() {
  for (std::size_t i = 0; i < records.size(); ++i) {
    Record& record = records[i];
    if (stays(record)) {
      record.posed.map_from_robot = *record.given;
      continue;
    }
    const std::size_t own = record.submap;
    if (own == kNoSubmap) {
      record.posed.map_from_robot = record.run_from_robot;
      continue;
    }
    const Submap& submap = graph.submap(own);
    const double middle = 0.5 * static_cast<double>(submap.first_scan + submap.last_scan);
    const bool later = static_cast<double>(i) >= middle;
    const std::size_t other = later ? own + 1 : own - 1;
    const Pose2 here = graph.map_from_run(own) * record.run_from_robot;
    record.posed.map_from_robot = here;
    const bool has_other =
        (later || own > 0) && other < graph.size() && graph.submap(other).run == submap.run;
    if (!has_other) continue;
    const Submap& next = graph.submap(other);
    const double other_middle = 0.5 * static_cast<double>(next.first_scan + next.last_scan);
    const double t = (static_cast<double>(i) - middle) / (other_middle - middle);
    record.posed.map_from_robot =
        interpolate(here, graph.map_from_run(other) * record.run_from_robot, t);
  }
}

SlamResult Slam::State::finish(int rounds, Progress* progress) {
  end_run();
  const bool all_stay = std::all_of(records.begin(), records.end(),
                                    [&](const Record& record) { return stays(record); });
  if (!all_stay) graph.tighten(2, progress);
  place_scans();
  SlamResult result;
  result.skipped_scans = checks.skipped();
  result.warnings = checks.warnings();
  result.loop_closures = graph.closures();
  for (Record& record : records) {
    record.used = stays(record) || located(record);
    if (!record.used) {
      if (result.unplaced_runs.empty() || result.unplaced_runs.back() != record.posed.run) {
        result.unplaced_runs.push_back(record.posed.run);
      }
      continue;
    }
    mapped.push_back(record.key);
    moves.push_back(!stays(record));
    result.scans.push_back(std::move(record.posed));
  }
  improve(result, rounds, progress);
  return result;
}

void Slam::State::improve(SlamResult& result, int rounds, Progress* progress) {
  EmConfig at_most = config.em;
  at_most.max_iterations = std::min(rounds, config.em.max_iterations);
  EmResult em = run_em(result.scans, mapped, moves, at_most, config.tracking, config.beam_filter,
                       pool, progress);
  result.raw = std::move(em.raw);
  result.occupancy = result.raw.reflection(config.beam_filter.min_evidence);
  result.filtered = std::move(em.filtered);
  result.log_likelihood = std::move(em.log_likelihood);
  result.iterations = em.iterations;
  result.dynamic_fraction = em.dynamic_fraction;
}

void Slam::State::track_again(SlamResult& before, State& again) {
  again.checks.skip_as(checks);
  std::size_t next = 0;
  for (Record& record : records) {
    PosedScan& posed = record.used ? before.scans[next++] : record.posed;
    const Observation observation{posed.run, std::move(posed.scan),
                                  record.odometry.value_or(Pose2{}), record.odometry.has_value()};
    again.add(observation, record.given ? &*record.given : nullptr, record.placed,
              posed.static_probability);
  }
}

SlamResult Slam::finish(Progress* progress) {
  const EmConfig& em = state_->config.em;
  if (!em.track_again) return state_->finish(em.max_iterations, progress);
  SlamResult result = state_->finish(kRoundsBefore, progress);
  const std::vector<bool>& moves = state_->moves;
  if (std::find(moves.begin(), moves.end(), true) == moves.end()) return result;
  if (result.dynamic_fraction < kWorthTrackingAgain) {
    // The trace goes on from its best round.
    std::vector<double> trace(result.log_likelihood.begin(),
                              result.log_likelihood.begin() + result.iterations + 1);
    state_->improve(result, em.max_iterations, progress);
    result.iterations += static_cast<int>(trace.size()) - 1;
    trace.insert(trace.end(), result.log_likelihood.begin() + 1, result.log_likelihood.end());
    result.log_likelihood = std::move(trace);
    return result;
  }
  auto again = std::make_unique<State>(state_->config, state_->pool.threads());
  state_->track_again(result, *again);
  state_ = std::move(again);
  return state_->finish(state_->config.em.max_iterations, progress);
}

}  // namespace strata::slam
