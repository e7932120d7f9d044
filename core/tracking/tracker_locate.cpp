// SPDX-License-Identifier: Apache-2.0
// Where the robot is by a scan: what is expected, and what the match says.
#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "core/geometry/angle.hpp"
#include "core/registration/correlative_search.hpp"
#include "core/registration/scan_matcher.hpp"
#include "core/tracking/pose_choice.hpp"
#include "core/tracking/tracker.hpp"
#include "core/tracking/tracker_parts.hpp"

namespace strata::slam {
namespace {

/// Without odometry a robot may do this between two scans; metres and radians.
constexpr double kBlindStddevM = 0.3;
constexpr double kBlindStddevRad = 0.3;
/// ... and is searched this much farther away after a poor match.
constexpr double kBlindWider = 2.0;
/// ... but nothing vouches for a pose at which less than this share are inliers.
constexpr double kBlindInlierShare = 0.5;

/// Without odometry the mean of so many steps goes on, in uneven time for so many of them at most.
constexpr std::size_t kMeanSteps = 3;
constexpr double kMaxExtrapolation = 3.0;
/// Stamps are regular while no two of the last scans came closer than this share of the mean.
constexpr double kRegularShare = 0.5;
/// ... else the poses of so many of them are starts too: the scans of two places may be mixed.
constexpr std::size_t kMixedScans = 4;

/// From here on the scan alone leaves its position open in some direction.
constexpr double kAmbiguousStddevM = 0.3;

/// The heading is open when a scan tells this share or less of what it would if every surface stood
/// in its way as it turns. In a round hall that is 1e-4 to 5e-3, on three real logs
/// (docs/notes/2026-11-23-slam.md) 0.05 or more.
constexpr double kOpenHeading = 0.01;

/// By how much larger an inlier share another start must have.
constexpr double kMargin = 0.02;

/// The heading is held by this.
constexpr double kFixedStddevRad = 1e-4;

/// A beam ends in the open when it ends farther than this from every surface, or at one that more
/// beams passed than hit: somebody was there.
constexpr double kStillStddevs = 3.0;
constexpr double kStillReflection = 0.5;

/// The end points that are inliers of something still at the pose.
Endpoints inliers_at(const Endpoints& endpoints, const SurfaceMap& map, const Pose2& pose,
                     double within_m) {
  const registration::MatchField& field = map.field();
  return those_of(endpoints, [&](std::size_t i) {
    const Eigen::Vector2d at = pose * endpoints.point_m(i);
    const registration::SurfacePoint* point = field.nearest(at.x(), at.y());
    if (point == nullptr) return false;
    if (map.reflection(point->x_m, point->y_m) < kStillReflection) return false;
    const double dx = at.x() - point->x_m;
    const double dy = at.y() - point->y_m;
    const double across = point->normal_x * dx + point->normal_y * dy;
    const double along =
        registration::beyond(point->normal_x * dy - point->normal_y * dx, point->slack_m);
    return !(std::hypot(across, std::sqrt(point->tangential) * along) > within_m);
  });
}

/// Where the heading is open, the pose with the guess's: the map would hold the robot back, since
/// it fits best as it stood wherever it turns. That of `found` otherwise, and where the guess's
/// heading explains less. prior: what `found` was matched with.
Pose2 with_known_heading(const registration::MatchResult& found, const Pose2Gaussian& guess,
                         const Pose2Gaussian& prior, const Endpoints& endpoints,
                         const registration::MatchField& field,
                         const registration::MatchConfig& config) {
  const Eigen::Matrix3d information = found.covariance.inverse() - prior.covariance.inverse();
  if (!found.converged || !is_heading_open(information, endpoints, config)) return found.pose;
  Pose2Gaussian straight = prior;
  straight.mean.theta = guess.mean.theta;
  straight.covariance.row(2).setZero();
  straight.covariance.col(2).setZero();
  straight.covariance(2, 2) = kFixedStddevRad * kFixedStddevRad;
  const registration::MatchResult fixed = registration::match(
      endpoints, {}, field, {found.pose.x, found.pose.y, guess.mean.theta}, &straight, config);
  const bool is_as_good = fixed.converged && fixed.inlier_share + kMargin >= found.inlier_share;
  return is_as_good ? fixed.pose : found.pose;
}

}  // namespace

Pose2Gaussian doubted_step(const Pose2& step, const OdometryNoiseConfig& noise, double doubt) {
  Pose2Gaussian result = odometry_step(step, step.translation().norm(), noise);
  result.covariance.topLeftCorner<2, 2>() *= doubt * doubt;
  return result;
}

bool is_ambiguous(const Eigen::Matrix3d& information) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(information.topLeftCorner<2, 2>(),
                                                            Eigen::EigenvaluesOnly);
  return axes.eigenvalues()(0) < 1.0 / (kAmbiguousStddevM * kAmbiguousStddevM);
}

bool is_heading_open(const Eigen::Matrix3d& information, const Endpoints& endpoints,
                     const registration::MatchConfig& config) {
  double lever_m2 = 0.0;
  for (std::size_t i = 0; i < endpoints.size(); ++i) {
    lever_m2 += static_cast<double>(endpoints.x_m[i]) * endpoints.x_m[i] +
                static_cast<double>(endpoints.y_m[i]) * endpoints.y_m[i];
  }
  // As beams are counted in `information`.
  const double share =
      std::min(1.0, config.effective_beams / static_cast<double>(endpoints.size()));
  const double most = share * lever_m2 / (config.hit_stddev_m * config.hit_stddev_m);
  // What is left when the robot may also move: in a round hall it turns about the hall's middle.
  Eigen::Matrix3d bounded = information;
  bounded.diagonal().array() += 1e-6;
  return 1.0 < kOpenHeading * most * bounded.inverse()(2, 2);
}

Eigen::Matrix3d turned(const Eigen::Matrix3d& covariance, const Pose2& turn) {
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  const double c = std::cos(turn.theta);
  const double s = std::sin(turn.theta);
  axes.topLeftCorner<2, 2>() << c, -s, s, c;
  return axes * covariance * axes.transpose();
}

Pose2Gaussian Tracker::predict(const Scan& scan, const Pose2* step) const {
  const Pose2Gaussian known{pose_.mean, Eigen::Matrix3d::Zero()};
  if (step != nullptr) return known * doubted_step(*step, config_.odometry, doubt_);
  if (!started_) return pose_;
  return known *
         Pose2Gaussian{going_on(scan.stamp), pose_covariance(kBlindStddevM, kBlindStddevRad)};
}

/// The mean of the last few steps between scans goes on, in the time since the last if stamps are
/// regular. Where they are those of delivery, several scans at once and then none for a second,
/// scans count as evenly spaced.
Pose2 Tracker::going_on(Stamp until) const {
  if (recent_.size() < 2) return {};
  const auto steps = static_cast<double>(std::min(recent_.size() - 1, kMeanSteps));
  const Recent& begin = recent_[recent_.size() - 1 - static_cast<std::size_t>(steps)];
  const double mean_s =
      (last_stamp_ - recent_.front().stamp).seconds() / static_cast<double>(recent_.size() - 1);
  double shortest_s = mean_s;
  for (std::size_t i = 1; i < recent_.size(); ++i) {
    shortest_s = std::min(shortest_s, (recent_[i].stamp - recent_[i - 1].stamp).seconds());
  }
  const double past_s = (last_stamp_ - begin.stamp).seconds();
  const bool regular = past_s > 0.0 && shortest_s > kRegularShare * mean_s;
  const double lost = lost_;
  double scale = 1.0 + lost;  // in steps
  if (regular) {
    const double passed = (until - last_stamp_).seconds() / (past_s / steps);
    scale = std::min(kMaxExtrapolation + lost, passed);
  }
  scale /= steps;
  // The chord of an arc, turned into the robot's own directions, and those of the arc to come.
  const Pose2 past = between(begin.pose, pose_.mean);
  const double turn = scale * past.theta;
  const Eigen::Vector2d chord = Pose2{0.0, 0.0, 0.5 * (turn - past.theta)} * past.translation();
  return {scale * chord.x(), scale * chord.y(), turn};
}

std::vector<Pose2> Tracker::other_guesses(const Pose2Gaussian& guess) const {
  // Odometry may be wrong as a whole: wheels that spin, a base that reports driving backwards as
  // driving forwards.
  const Pose2 step = between(pose_.mean, guess.mean);
  const Pose2 on_the_spot{0.0, 0.0, step.theta};
  const Pose2 reversed{-step.x, -step.y, step.theta};
  return {pose_.mean * between(last_pose_, pose_.mean), pose_.mean * on_the_spot,
          pose_.mean * reversed};
}

/// Where only beams that end in the open, if odometry is right, tell how far the robot has come
/// (people in a corridor), something that moved explains them as well: then the match without them,
/// in which odometry rules. Nothing where the others tell it too.
std::optional<registration::MatchResult> Tracker::match_still_alone(
    const Endpoints& endpoints, const Pose2Gaussian& guess) const {
  const SurfaceMap& map = active_.front().map;
  const Endpoints still =
      inliers_at(endpoints, map, guess.mean, kStillStddevs * config_.match.hit_stddev_m);
  if (still.size() == endpoints.size() || still.size() == 0) return std::nullopt;
  const registration::MatchResult alone =
      registration::match(still, {}, map.field(), guess.mean, &guess, config_.match);
  const bool open =
      alone.converged && is_ambiguous(alone.covariance.inverse() - guess.covariance.inverse());
  return open ? std::optional(alone) : std::nullopt;
}

bool Tracker::locate(const Endpoints& endpoints, std::size_t hits, const Pose2Gaussian& guess,
                     GuessFrom from, Pose2Gaussian& found, Eigen::Matrix3d& information) const {
  if (endpoints.size() < kMinHits) return false;
  const registration::MatchField& field = active_.front().map.field();
  registration::MatchResult result =
      registration::match(endpoints, {}, field, guess.mean, &guess, config_.match);
  // Away from the odometry only the scan decides.
  Pose2Gaussian wide{guess.mean, pose_covariance(kBlindStddevM, kBlindStddevRad)};
  const Pose2Gaussian* prior = &guess;
  // Beams side by side are no witnesses of their own, nor are those left of a scan in a crowd.
  const double share = std::min(1.0, config_.match.effective_beams / static_cast<double>(hits));
  auto try_from = [&](const Pose2& start, const Pose2& believed) {
    wide.mean = believed;
    const registration::MatchResult other =
        registration::match(endpoints, {}, field, start, &wide, config_.match);
    if (!other.converged || other.inlier_share <= result.inlier_share + kMargin) return;
    if (from == GuessFrom::kOdometry) {
      const double gain = share * likelier_by(other.pose, result.pose, endpoints,
                                              active_.front().map, config_.match);
      if (gain <= odder_by(other.pose, result.pose, guess, doubt_)) return;
    }
    result = other;
    prior = &wide;
  };
  if (result.inlier_share < config_.good_match) {
    for (const Pose2& start : other_guesses(guess)) try_from(start, start);
    // A clock that was set back by a second mixes the scans before and after, in order of time.
    for (std::size_t i = 2; i <= std::min(kMixedScans, recent_.size()); ++i) {
      if (from != GuessFrom::kMotion) break;
      const Pose2& before = recent_[recent_.size() - i].pose;
      try_from(before, before);
    }
  }
  if (result.inlier_share < config_.poor_match) {
    const registration::CorrelativeTables tables(field, {});
    const double wider = from == GuessFrom::kMotion ? kBlindWider : 1.0;
    const registration::SearchResult search =
        registration::search(endpoints, tables, guess.mean,
                             {wider * config_.search_window_m, wider * config_.search_window_m,
                              wider * config_.search_turn_rad},
                             std::max(config_.match.min_inlier_share, result.inlier_share));
    if (search.found) try_from(search.pose, guess.mean);
  }
  if (from == GuessFrom::kOdometry && result.converged) {
    if (const auto alone = match_still_alone(endpoints, guess)) {
      result = *alone;
      prior = &guess;
    }
  }
  if (from != GuessFrom::kMotion) {
    result.pose = with_known_heading(result, guess, *prior, endpoints, field, config_.match);
  }
  const bool blind = from == GuessFrom::kMotion;
  if (!result.converged || (blind && result.inlier_share < kBlindInlierShare)) return false;
  found = result.gaussian();
  information = result.covariance.inverse() - prior->covariance.inverse();
  return true;
}

}  // namespace strata::slam
