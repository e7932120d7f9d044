// SPDX-License-Identifier: Apache-2.0
#include "core/tracking/tracker.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "core/geometry/angle.hpp"
#include "core/tracking/tracker_parts.hpp"

namespace strata::slam {
namespace {

/// By so many scans stamps are judged regular or not.
constexpr std::size_t kRecentScans = 9;
/// So many scans in a row that match nothing are a new place; fewer were garbled.
constexpr int kMaxLost = 10;

/// How odometry drifts over many steps; its errors from step to step (OdometryNoiseConfig) are
/// allowed to be larger, since each match corrects them. Turns count as metres.
constexpr PathNoiseConfig kDrift{.per_root_metre_m = 0.1, .per_root_metre_rad = 0.02};

/// Odometry that agreed with the matches lately is believed more than its noise at the greatest:
/// along a corridor it then stands against the few beams that people send. Once it was wrong, as
/// when a base counts backwards as forwards, the doubt wears off by this factor a scan.
constexpr double kMinDoubt = 0.2;
constexpr double kDoubtDecay = 0.9;

/// However far they lie apart, from fewer scans a local map is too sparse to be matched against.
constexpr int kMinKeys = 4;

/// Covariance after a measurement of that information; the information may be singular.
Eigen::Matrix3d shrunk(const Eigen::Matrix3d& covariance, const Eigen::Matrix3d& information) {
  return (Eigen::Matrix3d::Identity() + covariance * information).inverse() * covariance;
}

/// Two independent opinions about one pose.
Pose2Gaussian fused(const Pose2Gaussian& a, const Pose2Gaussian& b) {
  const Eigen::Matrix3d gain = a.covariance * (a.covariance + b.covariance).inverse();
  const Eigen::Vector3d difference(b.mean.x - a.mean.x, b.mean.y - a.mean.y,
                                   angle_difference(b.mean.theta, a.mean.theta));
  const Eigen::Vector3d moved = gain * difference;
  return {{a.mean.x + moved.x(), a.mean.y + moved.y(), wrap_angle(a.mean.theta + moved.z())},
          (Eigen::Matrix3d::Identity() - gain) * a.covariance};
}

/// Those within reach that are not known to be dynamic.
Endpoints useful(const Endpoints& endpoints, double max_range_m,
                 std::span<const float> static_probability) {
  return those_of(endpoints, [&](std::size_t i) {
    if (std::hypot(endpoints.x_m[i], endpoints.y_m[i]) > max_range_m) return false;
    return static_probability.empty() || !is_dynamic(static_probability[endpoints.beam[i]]);
  });
}

}  // namespace

Endpoints match_endpoints(const Scan& scan, double max_range_m, int max_beams,
                          std::span<const float> static_probability) {
  return subsample(useful(endpoints_in_robot(scan), max_range_m, static_probability),
                   static_cast<std::size_t>(max_beams));
}

Tracker::Tracker(const TrackingConfig& config, double resolution_m, int run, const Pose2& start)
    : config_(config), resolution_m_(resolution_m), run_(run) {
  pose_ = {start, Eigen::Matrix3d::Zero()};
  last_pose_ = start;
}

void Tracker::remember(Stamp stamp) {
  if (lost_ > 0) recent_.clear();  // what it did since nobody knows
  recent_.push_back({stamp, pose_.mean});
  if (recent_.size() > kRecentScans) recent_.erase(recent_.begin());
}

void Tracker::grow_drift(const Pose2& step, const Pose2Gaussian* given) {
  const double distance_m = std::hypot(step.x, step.y);
  const double variance_m = kDrift.per_root_metre_m * kDrift.per_root_metre_m * distance_m;
  const double variance_rad =
      kDrift.per_root_metre_rad * kDrift.per_root_metre_rad * (distance_m + std::abs(step.theta));
  // A turn now is an offset later: the lever of heading over the step.
  Eigen::Matrix3d carry = Eigen::Matrix3d::Identity();
  const double c = std::cos(pose_.mean.theta);
  const double s = std::sin(pose_.mean.theta);
  carry(0, 2) = -(s * step.x + c * step.y);
  carry(1, 2) = c * step.x - s * step.y;
  drift_ = carry * drift_ * carry.transpose();
  drift_.diagonal() += Eigen::Vector3d(variance_m, variance_m, variance_rad);
  // Given poses hold the run: two of them differ by at most twice their variance.
  if (given != nullptr) drift_ = shrunk(drift_, (2.0 * given->covariance).inverse());
}

void Tracker::doubt_odometry(const ScanFindings& findings) {
  if (!findings.matched || findings.ambiguous) return;
  const Pose2& counted = findings.odometry_step;
  const double off_m = (findings.matched_step.translation() - counted.translation()).norm();
  const double now =
      off_m / std::sqrt(doubted_step(counted, config_.odometry, 1.0).covariance(0, 0));
  doubt_ = std::clamp(std::max(now, kDoubtDecay * doubt_), kMinDoubt, 1.0);
}

TrackedScan Tracker::add(const Scan& scan, const Pose2* odom_from_robot, std::size_t scan_index,
                         const Pose2Gaussian* given, std::span<const float> static_probability) {
  TrackedScan result;
  if (!first_scan_) first_scan_ = scan_index;
  turns_.see(scan);
  const OdometryStep step = odometry_.pass(scan.stamp, odom_from_robot);
  const Pose2* believed = step.kind == OdometryStep::Kind::kTold ? &step.motion : nullptr;
  result.findings.odometry_step = step.motion;
  result.findings.odometry_jumped = step.kind == OdometryStep::Kind::kJumped;
  const std::size_t all_hits = count_beams(scan).hits;
  result.findings.empty = all_hits == 0;
  Pose2Gaussian guess = predict(scan, believed);
  if (started_ && given != nullptr) guess = fused(guess, *given);
  result.run_from_robot = guess;
  if (started_) {
    grow_drift(between(pose_.mean, guess.mean), given);
    Eigen::Matrix3d information;
    // Two scanners send twice as many scans: each needs half of the beams.
    const int max_beams = config_.max_beams > 0
                              ? std::max(1, config_.max_beams / static_cast<int>(turns_.alive()))
                              : 0;
    const Endpoints endpoints =
        match_endpoints(scan, config_.max_range_m, max_beams, static_probability);
    const std::size_t most = max_beams > 0 ? static_cast<std::size_t>(max_beams) : all_hits;
    const std::size_t hits = std::min(all_hits, most);
    // A given pose in the guess is no count of steps: its error along a corridor must not rule.
    const GuessFrom from = given != nullptr      ? GuessFrom::kGivenPose
                           : believed != nullptr ? GuessFrom::kOdometry
                                                 : GuessFrom::kMotion;
    result.matched = locate(endpoints, hits, guess, from, result.run_from_robot, information);
    if (result.matched) drift_ = shrunk(drift_, information);
    result.findings.matched = result.matched;
    result.findings.ambiguous = result.matched && is_ambiguous(information);
    result.findings.heading_open =
        result.matched && is_heading_open(information, endpoints, config_.match);
    result.findings.few = endpoints.size() > 0 && endpoints.size() < kMinHits;
    result.findings.matched_step = between(pose_.mean, result.run_from_robot.mean);
    if (believed != nullptr) doubt_odometry(result.findings);
  }
  // Without odometry where such a scan was taken is anybody's guess: it must not enter the map, nor
  // may the way go on from there.
  const bool blind = odom_from_robot == nullptr && given == nullptr;
  lost_ = started_ && blind && !result.matched ? lost_ + 1 : 0;
  if (lost_ > 0 && lost_ <= kMaxLost) return result;
  path_m_ += translation_distance(pose_.mean, result.run_from_robot.mean);
  // Odometry that comes back has this way in its motion too, and must not add it again.
  if (odom_from_robot == nullptr) {
    odometry_.moved_otherwise(between(pose_.mean, result.run_from_robot.mean));
  }
  last_pose_ = pose_.mean;
  pose_ = result.run_from_robot;
  last_stamp_ = scan.stamp;
  remember(scan.stamp);
  const bool moved =
      !last_key_ || has_moved(*last_key_, pose_.mean, config_.key_distance_m, config_.key_turn_rad);
  if (moved && !result.findings.empty && turns_.has_turn()) {
    turns_.use();
    result.key = true;
    last_key_ = pose_.mean;
    insert(scan, scan_index, static_probability);
    started_ = true;
  }
  return result;
}

bool Tracker::is_complete(const Active& active) const {
  if (active.keys >= config_.local_map_keys) return true;
  return active.keys >= kMinKeys && path_m_ - active.from_m >= config_.local_map_length_m;
}

void Tracker::insert(const Scan& scan, std::size_t scan_index,
                     std::span<const float> static_probability) {
  if (active_.empty()) {
    active_.push_back({SurfaceMap(resolution_m_, config_.field), 0, path_m_});
    owned_from_ = *first_scan_;  // with those that hit nothing yet
    owned_pose_ = pose_.mean;
    drift_.setZero();
  }
  if (is_complete(active_.back())) {
    if (active_.size() == 2) {
      const Pose2 back{0.0, 0.0, -owned_pose_.theta};
      close_oldest(scan_index);
      owned_pose_ = pose_.mean;
      owned_drift_ = turned(drift_, back);
      drift_.setZero();
    }
    active_.push_back({SurfaceMap(resolution_m_, config_.field), 0, path_m_});
  }
  for (Active& active : active_) {
    active.map.add(scan, pose_.mean * scan.robot_from_laser, static_probability,
                   config_.max_range_m);
    ++active.keys;
  }
}

void Tracker::close_oldest(std::size_t end_scan) {
  finished_.push_back(
      make_local_map(active_.front().map, run_, owned_pose_, owned_from_, end_scan));
  finished_.back().from_previous = owned_drift_;
  active_.erase(active_.begin());
  owned_from_ = end_scan;
}

std::vector<LocalMap> Tracker::take_finished() { return std::exchange(finished_, {}); }

void Tracker::finish(std::size_t end_scan) {
  if (active_.empty()) return;
  // The younger map holds only scans that the older one holds too.
  close_oldest(end_scan);
  active_.clear();
}

bool Tracker::is_sound(std::size_t scans) const {
  return owned_from_ <= scans && first_scan_.value_or(0) <= scans &&
         std::all_of(finished_.begin(), finished_.end(),
                     [&](const LocalMap& local_map) { return local_map.is_of(scans); });
}

void Tracker::begin_maps(std::size_t count) {
  active_.clear();
  for (std::size_t i = 0; i < count; ++i) {
    active_.push_back({SurfaceMap(resolution_m_, config_.field)});
  }
}

}  // namespace strata::slam
