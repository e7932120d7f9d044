// SPDX-License-Identifier: Apache-2.0
#include "core/slam/slam.hpp"

#include <algorithm>
#include <utility>

#include "core/slam/slam_state.hpp"

namespace strata::slam {
namespace {

/// How far a local map of scans that are placed may give way: hardly.
constexpr double kPlacedStddevM = 0.005;
constexpr double kPlacedStddevRad = 0.001;

/// Scans before the window are looked through for those to forget once in so many scans.
constexpr std::size_t kForgetEvery = 64;

bool is_repeated(const Scan& scan, const Scan& last) {
  return scan.stamp == last.stamp && LogChecks::are_same_readings(scan.ranges_m, last.ranges_m);
}

}  // namespace

void Slam::State::start_run(const Observation& observation, const Pose2* given_pose) {
  end_run();
  forget_starts();
  run = observation.run;
  ++runs;
  run_is_given = given_pose != nullptr;
  start = given_pose == nullptr ? next_start : std::nullopt;
  next_start.reset();
  Pose2 run_from_robot;
  if (given_pose != nullptr) {
    run_from_robot = *given_pose;
  } else if (start) {
    run_from_robot = start->mean;
    begun_at.emplace_back(run, *start);
  } else if (observation.has_odometry) {
    // The map frame is the odometry frame at the first scan of the first run.
    run_from_robot = observation.odom_from_robot;
  }
  map_from_run = {};
  tracker.emplace(config.tracking, config.beam_filter.resolution_m, run, run_from_robot);
}

void Slam::State::end_run() {
  if (!tracker) return;
  tracker->finish(accepted);
  take_local_maps();
  graph.end_run();
  tracker.reset();
}

Pose2Gaussian Slam::State::believed(const Pose2& given, bool placed) const {
  const double sigma_m = placed ? kPlacedStddevM : config.given_poses.stddev_m;
  const double sigma_rad = placed ? kPlacedStddevRad : config.given_poses.stddev_rad;
  return {given, pose_covariance(sigma_m, sigma_rad)};
}

std::optional<Pose2Gaussian> Slam::State::given_local_map(const LocalMap& local_map) {
  std::vector<Pose2> tracked;
  std::vector<Pose2> given;
  const std::span<const Record> own = numbered(local_map.first_scan, local_map.last_scan);
  for (const Record& record : own) {
    if (!record.given) continue;
    tracked.push_back(record.run_from_robot);
    given.push_back(*record.given);
  }
  if (given.empty()) return std::nullopt;
  // The run's drifting frame is aligned with the given poses as a rigid whole, heading included:
  // the positions of a short piece say little about its heading.
  std::vector<Pose2> corrections;
  for (std::size_t i = 0; i < given.size(); ++i) {
    corrections.push_back(given[i] * inverse(tracked[i]) * local_map.run_from_local_map);
  }
  const std::vector<double> weights(corrections.size(), 1.0);
  return believed(weighted_gaussian(corrections, weights).mean, own.front().placed);
}

std::span<Record> Slam::State::numbered(std::size_t first, std::size_t last) {
  const auto from = [&](std::size_t number) {
    return std::lower_bound(
        records.begin(), records.end(), number,
        [](const Record& record, std::size_t least) { return record.number < least; });
  };
  return {from(first), from(last)};
}

void Slam::State::take_local_maps() {
  for (LocalMap& local_map : tracker->take_finished()) {
    std::optional<Pose2Gaussian> given = given_local_map(local_map);
    // The run's frame is the map's, as far as its start is known.
    if (!given && start) given = Pose2Gaussian{local_map.run_from_local_map, start->covariance};
    start.reset();
    const std::size_t first = local_map.first_scan;
    const std::size_t last = local_map.last_scan;
    const std::size_t index = graph.add(std::move(local_map), given);
    for (Record& record : numbered(first, last)) record.local_map = index;
    map_from_run = graph.map_from_run(index);
    if (keep.window_scans > 0) forget_local_maps();
  }
}

std::size_t Slam::State::drop_scans_of(const std::vector<std::size_t>& gone) {
  if (gone.empty()) return 0;
  forgot = true;
  const std::size_t dropped = std::erase_if(records, [&](const Record& record) {
    return std::binary_search(gone.begin(), gone.end(), record.local_map);
  });
  for (Record& record : records) {
    if (record.local_map == kNoLocalMap) continue;
    const auto below = std::lower_bound(gone.begin(), gone.end(), record.local_map);
    record.local_map -= static_cast<std::size_t>(below - gone.begin());
  }
  return dropped;
}

void Slam::State::forget_local_maps() {
  const std::size_t window = std::min(accepted, static_cast<std::size_t>(keep.window_scans));
  (void)drop_scans_of(graph.forget(keep, accepted - window));
  std::vector<int> run_of;
  for (std::size_t i = 0; i < graph.size(); ++i) run_of.push_back(graph.local_map(i).run);
  const std::vector<std::size_t> gone = graph.forget_unplaced(accepted - window);
  for (std::size_t i = 0; i < gone.size(); ++i) {
    unplaced.runs += i == 0 || run_of[gone[i]] != run_of[gone[i - 1]] ? 1 : 0;
  }
  unplaced.scans += drop_scans_of(gone);
}

void Slam::State::forget_starts() {
  std::erase_if(begun_at, [&](const auto& known) {
    return std::none_of(records.begin(), records.end(),
                        [&](const Record& record) { return record.posed.run == known.first; });
  });
}

/// A robot that stands still adds nothing to the map: what is not in a local map goes with the
/// window.
void Slam::State::forget_scans() {
  const auto window = static_cast<std::size_t>(keep.window_scans);
  if (window == 0 || accepted <= window || accepted % kForgetEvery != 0) return;
  const std::size_t kept = records.size();
  std::erase_if(records, [&](const Record& record) {
    return !record.key && record.number + window < accepted;
  });
  forgot = forgot || records.size() < kept;
}

Slam::Slam(const SlamConfig& config, int threads, const KeepConfig& keep) {
  require_valid(config, "slam");
  require_valid(keep, "keep");
  state_ = std::make_unique<State>(config, threads, keep);
}

Slam::~Slam() = default;

void Slam::begin_next_run_at(const Pose2Gaussian& map_from_robot) {
  state_->next_start = map_from_robot;
}

std::size_t Slam::skipped_scans() const { return state_->checks.skipped(); }
std::size_t Slam::kept_scans() const { return state_->records.size(); }
std::size_t Slam::kept_local_maps() const { return state_->graph.size(); }
Slam::Unplaced Slam::forgotten_unplaced() const { return state_->unplaced; }

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
    if (is_repeated(observation.scan, last)) skip = LogChecks::Skip::kRepeated;
  }
  if (skip) {
    if (!placed) checks.skip(*skip);
    if (records.empty()) return {};
    return {records.back().posed.map_from_robot, Eigen::Matrix3d::Identity()};
  }
  if (new_run) start_run(observation, given_pose);
  last_stamp = observation.scan.stamp;
  const Pose2* step = observation.has_odometry ? &observation.odom_from_robot : given_pose;
  const Pose2Gaussian given =
      given_pose != nullptr ? believed(*given_pose, placed) : Pose2Gaussian{};
  const TrackedScan tracked =
      tracker->add(observation.scan, step, accepted,
                   run_is_given && given_pose != nullptr ? &given : nullptr, static_probability);
  // What was odd about earlier runs was said when they were learned; they are many.
  if (!placed) checks.add(observation.scan, new_run, tracked.findings);
  Record record;
  record.number = accepted++;
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
  take_local_maps();
  forget_scans();
  return result;
}

}  // namespace strata::slam
