// SPDX-License-Identifier: Apache-2.0
#include "core/slam/tracker.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "core/geometry/angle.hpp"
#include "core/registration/correlative_search.hpp"
#include "core/registration/scan_matcher.hpp"

namespace strata::slam {
namespace {

/// Without odometry a robot may do this between two scans; metres and radians.
constexpr double kBlindStddevM = 0.3;
constexpr double kBlindStddevRad = 0.3;

/// How odometry drifts over many steps; its errors from step to step (OdometryNoiseConfig) are
/// allowed to be larger, since each match corrects them.
constexpr double kDriftM = 0.1;     // per square root of a metre
constexpr double kDriftRad = 0.02;  // per square root of a metre or radian

/// No robot with wheels goes on faster than this, indoors or out; within the first allowance stamps
/// may be off.
constexpr double kMostSpeedMps = 5.0;
constexpr double kMostTurnRps = 6.0;
constexpr double kAllowanceM = 1.0;
constexpr double kAllowanceRad = 1.0;

bool is_possible(const Pose2& step, double time_s) {
  return std::hypot(step.x, step.y) <= kAllowanceM + kMostSpeedMps * time_s &&
         std::abs(step.theta) <= kAllowanceRad + kMostTurnRps * time_s;
}

/// Odometry that agreed with the matches lately is believed more than its noise at the greatest:
/// along a corridor it then stands against the few beams that people send. Once it was wrong, as
/// when a base counts backwards as forwards, the doubt wears off by this factor a scan.
constexpr double kLeastDoubt = 0.2;
constexpr double kDoubtDecay = 0.9;

/// odometry_step with the standard deviation of its position times `doubt`.
Pose2Gaussian doubted_step(const Pose2& step, const OdometryNoiseConfig& noise, double doubt) {
  Pose2Gaussian result = odometry_step(step, step.translation().norm(), noise);
  result.covariance.topLeftCorner<2, 2>() *= doubt * doubt;
  return result;
}

/// From here on the scan alone leaves its position open in some direction.
constexpr double kAmbiguousStddevM = 0.3;

bool is_ambiguous(const Eigen::Matrix3d& information) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(information.topLeftCorner<2, 2>(),
                                                            Eigen::EigenvaluesOnly);
  return axes.eigenvalues()(0) < 1.0 / (kAmbiguousStddevM * kAmbiguousStddevM);
}

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

/// A covariance of (x, y, theta) in axes turned by `turn`.
Eigen::Matrix3d turned(const Eigen::Matrix3d& covariance, const Pose2& turn) {
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  const double c = std::cos(turn.theta);
  const double s = std::sin(turn.theta);
  axes.topLeftCorner<2, 2>() << c, -s, s, c;
  return axes * covariance * axes.transpose();
}

/// Those within reach that are not known to be dynamic.
Endpoints useful(const Endpoints& endpoints, double max_range_m,
                 std::span<const float> static_probability) {
  Endpoints result;
  for (std::size_t i = 0; i < endpoints.size(); ++i) {
    if (std::hypot(endpoints.x_m[i], endpoints.y_m[i]) > max_range_m) continue;
    if (!static_probability.empty() && static_probability[endpoints.beam[i]] < 0.5F) continue;
    result.x_m.push_back(endpoints.x_m[i]);
    result.y_m.push_back(endpoints.y_m[i]);
    result.beam.push_back(endpoints.beam[i]);
  }
  return result;
}

}  // namespace

Endpoints match_endpoints(const Scan& scan, double max_range_m, int max_beams,
                          std::span<const float> static_probability) {
  return thin(useful(endpoints_in_robot(scan), max_range_m, static_probability),
              static_cast<std::size_t>(max_beams));
}

Tracker::Tracker(const TrackingConfig& config, double resolution_m, int run, const Pose2& start)
    : config_(config), resolution_m_(resolution_m), run_(run) {
  pose_.mean = start;
  last_pose_ = start;
}

Pose2Gaussian Tracker::predict(const Scan& scan, const Pose2* odom_from_robot) const {
  const Pose2Gaussian known{pose_.mean, Eigen::Matrix3d::Zero()};
  if (odom_from_robot != nullptr && last_odom_) {
    return known * doubted_step(between(*last_odom_, *odom_from_robot), config_.odometry, doubt_);
  }
  if (!started_) return pose_;
  const double step_s = (scan.stamp - last_stamp_).seconds();
  const double scale = last_step_s_ > 0.0 ? std::min(3.0, step_s / last_step_s_) : 0.0;
  const Pose2 last_step = between(last_pose_, pose_.mean);
  Pose2Gaussian step{{scale * last_step.x, scale * last_step.y, scale * last_step.theta},
                     Eigen::Matrix3d::Zero()};
  step.covariance.diagonal() << kBlindStddevM * kBlindStddevM, kBlindStddevM * kBlindStddevM,
      kBlindStddevRad * kBlindStddevRad;
  return known * step;
}

std::vector<Pose2> Tracker::other_guesses(const Pose2Gaussian& guess) const {
  // Odometry may be wrong as a whole: wheels that spin, a base that reports driving backwards as
  // driving forwards.
  const Pose2 step = between(pose_.mean, guess.mean);
  const Pose2 turned{0.0, 0.0, step.theta};
  const Pose2 reversed{-step.x, -step.y, step.theta};
  return {pose_.mean * between(last_pose_, pose_.mean), pose_.mean * turned, pose_.mean * reversed};
}

bool Tracker::locate(const Endpoints& endpoints, const Pose2Gaussian& guess, Pose2Gaussian& found,
                     Eigen::Matrix3d& information) const {
  constexpr double kMargin = 0.02;  // by how much another start must explain more
  if (endpoints.size() == 0) return false;
  const registration::MatchField& field = active_.front().map.field();
  registration::MatchResult result =
      registration::match(endpoints, {}, field, guess.mean, &guess, config_.match);
  // Away from the odometry only the scan decides.
  Pose2Gaussian wide{guess.mean, Eigen::Matrix3d::Zero()};
  wide.covariance.diagonal() << kBlindStddevM * kBlindStddevM, kBlindStddevM * kBlindStddevM,
      kBlindStddevRad * kBlindStddevRad;
  const Pose2Gaussian* prior = &guess;
  auto try_from = [&](const Pose2& start, const Pose2& believed) {
    wide.mean = believed;
    const registration::MatchResult other =
        registration::match(endpoints, {}, field, start, &wide, config_.match);
    if (!other.converged || other.explained <= result.explained + kMargin) return;
    result = other;
    prior = &wide;
  };
  if (result.explained < config_.good_match) {
    for (const Pose2& start : other_guesses(guess)) try_from(start, start);
  }
  if (result.explained < config_.poor_match) {
    const registration::CorrelativeTables tables(field, {});
    const registration::SearchResult search = registration::search(
        endpoints, tables, guess.mean,
        {config_.search_window_m, config_.search_window_m, config_.search_turn_rad},
        std::max(config_.match.min_explained, result.explained));
    if (search.found) try_from(search.pose, guess.mean);
  }
  if (!result.converged) return false;
  found = result.gaussian();
  information = result.covariance.inverse() - prior->covariance.inverse();
  return true;
}

void Tracker::grow_drift(const Pose2& step, const Pose2Gaussian* given) {
  const double distance_m = std::hypot(step.x, step.y);
  const double variance_m = kDriftM * kDriftM * distance_m;
  const double variance_rad = kDriftRad * kDriftRad * (distance_m + std::abs(step.theta));
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
  doubt_ = std::clamp(std::max(now, kDoubtDecay * doubt_), kLeastDoubt, 1.0);
}

TrackedScan Tracker::add(const Scan& scan, const Pose2* odom_from_robot, std::size_t scan_index,
                         const Pose2Gaussian* given, std::span<const float> static_probability) {
  TrackedScan result;
  if (!first_scan_) first_scan_ = scan_index;
  const Pose2* believed = odom_from_robot;
  if (odom_from_robot != nullptr && last_odom_) {
    result.findings.odometry_step = between(*last_odom_, *odom_from_robot);
    result.findings.odometry_jumped =
        !is_possible(result.findings.odometry_step, (scan.stamp - last_stamp_).seconds());
    if (result.findings.odometry_jumped) believed = nullptr;
  }
  result.findings.empty = count_beams(scan).hits == 0;
  Pose2Gaussian guess = predict(scan, believed);
  if (started_ && given != nullptr) guess = fused(guess, *given);
  result.run_from_robot = guess;
  if (started_) {
    grow_drift(between(pose_.mean, guess.mean), given);
    Eigen::Matrix3d information;
    const Endpoints endpoints =
        match_endpoints(scan, config_.max_range_m, config_.max_beams, static_probability);
    result.matched = locate(endpoints, guess, result.run_from_robot, information);
    if (result.matched) drift_ = shrunk(drift_, information);
    result.findings.matched = result.matched;
    result.findings.ambiguous = result.matched && is_ambiguous(information);
    result.findings.matched_step = between(pose_.mean, result.run_from_robot.mean);
    if (believed != nullptr) doubt_odometry(result.findings);
  }
  last_pose_ = pose_.mean;
  last_step_s_ = started_ ? (scan.stamp - last_stamp_).seconds() : 0.0;
  pose_ = result.run_from_robot;
  last_stamp_ = scan.stamp;
  if (odom_from_robot != nullptr) last_odom_ = *odom_from_robot;
  const bool moved =
      !last_key_ || translation_distance(*last_key_, pose_.mean) >= config_.key_distance_m ||
      std::abs(angle_difference(pose_.mean.theta, last_key_->theta)) >= config_.key_turn_rad;
  if (moved && !result.findings.empty) {
    result.key = true;
    last_key_ = pose_.mean;
    insert(scan, scan_index, static_probability);
    started_ = true;
  }
  return result;
}

void Tracker::insert(const Scan& scan, std::size_t scan_index,
                     std::span<const float> static_probability) {
  if (active_.empty()) {
    active_.push_back({SurfaceMap(resolution_m_, config_.field), 0});
    owned_from_ = *first_scan_;  // with those that hit nothing yet
    owned_pose_ = pose_.mean;
    drift_.setZero();
  }
  if (active_.back().keys >= config_.submap_keys) {
    if (active_.size() == 2) {
      const Pose2 back{0.0, 0.0, -owned_pose_.theta};
      close_oldest(scan_index);
      owned_pose_ = pose_.mean;
      owned_drift_ = turned(drift_, back);
      drift_.setZero();
    }
    active_.push_back({SurfaceMap(resolution_m_, config_.field), 0});
  }
  for (Active& active : active_) {
    active.map.add(scan, pose_.mean * scan.robot_from_laser, static_probability,
                   config_.max_range_m);
    ++active.keys;
  }
}

void Tracker::close_oldest(std::size_t end_scan) {
  finished_.push_back(make_submap(active_.front().map, run_, owned_pose_, owned_from_, end_scan));
  finished_.back().from_previous = owned_drift_;
  active_.erase(active_.begin());
  owned_from_ = end_scan;
}

std::vector<Submap> Tracker::take_finished() { return std::exchange(finished_, {}); }

void Tracker::finish(std::size_t end_scan) {
  if (active_.empty()) return;
  // The younger map holds only scans that the older one holds too.
  close_oldest(end_scan);
  active_.clear();
}

}  // namespace strata::slam
