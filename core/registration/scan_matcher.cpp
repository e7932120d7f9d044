// SPDX-License-Identifier: Apache-2.0
#include "core/registration/scan_matcher.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "core/geometry/angle.hpp"
#include "core/registration/match_kernel.hpp"

namespace strata::registration {
namespace {

Eigen::Vector3d difference_from(const Pose2& pose, const Pose2& mean) {
  return {pose.x - mean.x, pose.y - mean.y, angle_difference(pose.theta, mean.theta)};
}

/// One scan against one map.
struct MatchProblem {
  MatchBeams beams;
  std::size_t hits;
  const MatchField& field;
  bool has_prior = false;
  Pose2 prior_mean;
  Eigen::Matrix3d prior_information = Eigen::Matrix3d::Zero();
  double hit_weight = 0.95;
};

template <bool kDerivatives>
MatchCost evaluate(const MatchProblem& problem, const Pose2& pose, double hit_stddev_m) {
  const MatchSums sums =
      sum_match(problem.beams, problem.field, pose, hit_stddev_m, problem.hit_weight, kDerivatives);
  MatchCost result;
  result.cost = -sums.log_mixture;
  result.scan_cost = result.cost;
  result.inlier_share = sums.weight > 0.0 ? sums.inlier_weight / sums.weight : 0.0;
  if constexpr (kDerivatives) {
    const double* h = sums.hessian;
    result.gradient = {sums.gradient[0], sums.gradient[1], sums.gradient[2]};
    result.hessian << h[0], h[1], h[3], h[1], h[2], h[4], h[3], h[4], h[5];
  }
  if (problem.has_prior) {
    const Eigen::Vector3d d = difference_from(pose, problem.prior_mean);
    const Eigen::Vector3d pull = problem.prior_information * d;
    result.cost += 0.5 * d.dot(pull);
    if constexpr (kDerivatives) {
      result.gradient += pull;
      result.hessian += problem.prior_information;
    }
  }
  return result;
}

struct LevelResult {
  Pose2 pose;
  bool converged = false;
  int iterations = 0;
};

/// Levenberg-Marquardt over three parameters.
/// first: the cost at `start`; last: set to the cost where it ends.
LevelResult minimize(const MatchProblem& problem, const Pose2& start, double hit_stddev_m,
                     int max_iterations, const MatchCost& first, MatchCost& last) {
  // Metres and radians: a thousandth of what a beam is trusted.
  const double step_tolerance = 1e-3 * hit_stddev_m;
  LevelResult result{start, false, 0};
  MatchCost& here = last;
  here = first;
  double damping = 1e-4;
  while (result.iterations < max_iterations) {
    ++result.iterations;
    Eigen::Matrix3d damped = here.hessian;
    damped.diagonal() *= 1.0 + damping;
    damped.diagonal().array() += 1e-9;
    const Eigen::Vector3d step = -damped.llt().solve(here.gradient);
    if (!step.allFinite()) return result;
    const Pose2 candidate{result.pose.x + step.x(), result.pose.y + step.y(),
                          wrap_angle(result.pose.theta + step.z())};
    const MatchCost there = evaluate<true>(problem, candidate, hit_stddev_m);
    const bool better = there.cost <= here.cost;
    if (better) {
      result.pose = candidate;
      here = there;
      damping = std::max(1e-7, damping * 0.1);
    } else {
      damping *= 10.0;
    }
    if (step.cwiseAbs().maxCoeff() < step_tolerance || damping > 1e6) {
      result.converged = true;
      return result;
    }
  }
  return result;
}

MatchProblem make_problem(const Endpoints& endpoints, std::span<const float> beam_weights,
                          const MatchField& field, const Pose2Gaussian* prior, double hit_weight) {
  MatchProblem problem{MatchBeams(endpoints, beam_weights),
                       endpoints.size(),
                       field,
                       false,
                       {},
                       Eigen::Matrix3d::Zero(),
                       hit_weight};
  if (prior != nullptr) {
    problem.has_prior = true;
    problem.prior_mean = prior->mean;
    problem.prior_information = prior->covariance.inverse();
  }
  return problem;
}

/// The information that the scan itself holds, per beam counted once. The Hessian holds the nearest
/// surface fixed: along a bare wall it sees the gaps between the wall's cells as if they were
/// shape. So the least certain direction is tried out: how much the cost really rises on the way.
Eigen::Matrix3d scan_information(const MatchProblem& problem, const Pose2& pose,
                                 const MatchCost& at, const MatchConfig& config) {
  constexpr double kTrialSteps = 3.0;  // standard deviations of a beam
  Eigen::Matrix3d information = at.hessian - problem.prior_information;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(information.topLeftCorner<2, 2>());
  const double analytic = axes.eigenvalues()(0);
  const Eigen::Vector2d weak = axes.eigenvectors().col(0);
  MatchProblem alone = problem;
  alone.has_prior = false;
  const double step_m = kTrialSteps * config.hit_stddev_m;
  const auto cost_at = [&](double along_m) {
    return evaluate<false>(alone,
                           {pose.x + along_m * weak.x(), pose.y + along_m * weak.y(), pose.theta},
                           config.hit_stddev_m)
        .cost;
  };
  const double rise = 0.5 * (cost_at(step_m) + cost_at(-step_m)) - at.scan_cost;
  const double tried = std::max(0.0, 2.0 * rise / (step_m * step_m));
  if (tried >= analytic || analytic <= 0.0) return information;
  // Shrinks the weak axis and its couplings alike, so that the matrix stays positive.
  const double scale = std::sqrt(tried / analytic) - 1.0;
  Eigen::Matrix3d shrink = Eigen::Matrix3d::Identity();
  shrink.topLeftCorner<2, 2>() += scale * weak * weak.transpose();
  return shrink * information * shrink;
}

/// Covariance from the curvature, with correlated beams counted as few (`effective_beams`).
Eigen::Matrix3d covariance_of(const MatchProblem& problem, const Pose2& pose, const MatchCost& at,
                              const MatchConfig& config) {
  const double share = std::min(1.0, config.effective_beams / static_cast<double>(problem.hits));
  Eigen::Matrix3d information = scan_information(problem, pose, at, config) * share;
  information += problem.prior_information;
  // A direction that nothing measures is uncertain by kilometres, not by infinity.
  information.diagonal().array() += 1e-6;
  return information.inverse();
}

}  // namespace

MatchCost evaluate_match(const Endpoints& endpoints, std::span<const float> beam_weights,
                         const MatchField& field, const Pose2& pose, const Pose2Gaussian* prior,
                         double hit_stddev_m, double hit_weight) {
  return evaluate<true>(make_problem(endpoints, beam_weights, field, prior, hit_weight), pose,
                        hit_stddev_m);
}

MatchResult match(const Endpoints& endpoints, std::span<const float> beam_weights,
                  const MatchField& field, const Pose2& guess, const Pose2Gaussian* prior,
                  const MatchConfig& config) {
  MatchResult result;
  result.pose = guess;
  const MatchProblem problem =
      make_problem(endpoints, beam_weights, field, prior, config.hit_weight);
  if (endpoints.size() == 0) {
    result.covariance =
        prior != nullptr ? prior->covariance : Eigen::Matrix3d(Eigen::Matrix3d::Identity() * 1e6);
    return result;
  }
  LevelResult level{guess, false, 0};
  const MatchCost here = evaluate<true>(problem, guess, config.hit_stddev_m);
  MatchCost there;
  for (int i = config.levels - 1; i >= 0; --i) {
    const double sigma = config.hit_stddev_m * std::pow(2.0, i);
    const bool at_guess = i == 0 && config.levels == 1;
    const MatchCost first = at_guess ? here : evaluate<true>(problem, level.pose, sigma);
    level = minimize(problem, level.pose, sigma, config.max_iterations, first, there);
    result.iterations += level.iterations;
  }
  const bool improved = there.cost <= here.cost;
  if (improved) {
    result.pose = level.pose;
  } else {
    there = here;
  }
  result.cost = there.cost;
  result.inlier_share = there.inlier_share;
  result.covariance = covariance_of(problem, result.pose, there, config);
  const Eigen::Matrix2d position = result.covariance.topLeftCorner<2, 2>();
  const double worst = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(position).eigenvalues()(1);
  result.converged = level.converged && improved &&
                     result.inlier_share >= config.min_inlier_share &&
                     worst <= config.max_condition_stddev_m * config.max_condition_stddev_m;
  return result;
}

}  // namespace strata::registration
