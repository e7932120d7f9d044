// SPDX-License-Identifier: Apache-2.0
#include "tests/core/registration/ceres_solver.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <ceres/ceres.h>

#include "core/geometry/angle.hpp"

namespace strata::registration {
namespace {

/// -2 ln of the mixture as a loss over s = D^2 / sigma_l^2, zero at s = 0.
class MixtureLoss final : public ceres::LossFunction {
 public:
  explicit MixtureLoss(double hit_weight) : hit_(hit_weight), random_(1.0 - hit_weight) {}
  void Evaluate(double s, double rho[3]) const override {
    const double hit = hit_ * std::exp(-0.5 * s);
    const double sum = hit + random_;
    const double posterior = hit / sum;
    rho[0] = -2.0 * std::log(sum / (hit_ + random_));
    rho[1] = posterior;
    rho[2] = -0.5 * posterior * (1.0 - posterior);
  }

 private:
  double hit_;
  double random_;
};

/// Far from every surface: a distance at which the mixture is flat.
constexpr double kFarWhitened = 40.0;

class BeamCost final : public ceres::SizedCostFunction<2, 3> {
 public:
  BeamCost(double x_m, double y_m, const MatchField& field, double hit_stddev_m)
      : x_m_(x_m), y_m_(y_m), field_(field), hit_stddev_m_(hit_stddev_m) {}
  bool Evaluate(const double* const* parameters, double* residuals,
                double** jacobians) const override {
    double* jacobian = jacobians != nullptr ? jacobians[0] : nullptr;
    if (!beam_residual(x_m_, y_m_, field_, parameters[0], hit_stddev_m_, residuals, jacobian)) {
      residuals[0] = kFarWhitened;
      residuals[1] = 0.0;
      if (jacobian != nullptr) std::fill(jacobian, jacobian + 6, 0.0);
    }
    return true;
  }

 private:
  double x_m_;
  double y_m_;
  const MatchField& field_;
  double hit_stddev_m_;
};

class PriorCost final : public ceres::SizedCostFunction<3, 3> {
 public:
  explicit PriorCost(const Pose2Gaussian& prior)
      : mean_(prior.mean), whitener_(prior.covariance.inverse().llt().matrixU()) {}
  bool Evaluate(const double* const* parameters, double* residuals,
                double** jacobians) const override {
    const Eigen::Vector3d difference(parameters[0][0] - mean_.x, parameters[0][1] - mean_.y,
                                     angle_difference(parameters[0][2], mean_.theta));
    Eigen::Map<Eigen::Vector3d> whitened(residuals);
    whitened = whitener_ * difference;
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> jacobian(jacobians[0]);
      jacobian = whitener_;
    }
    return true;
  }

 private:
  Pose2 mean_;
  Eigen::Matrix3d whitener_;
};

}  // namespace

bool beam_residual(double x_robot_m, double y_robot_m, const MatchField& field,
                   const double pose[3], double hit_stddev_m, double residual[2],
                   double* jacobian) {
  const double c = std::cos(pose[2]);
  const double s = std::sin(pose[2]);
  const double rotated_x = c * x_robot_m - s * y_robot_m;
  const double rotated_y = s * x_robot_m + c * y_robot_m;
  const double x = pose[0] + rotated_x;
  const double y = pose[1] + rotated_y;
  const SurfacePoint* surface = field.nearest(x, y);
  if (surface == nullptr) return false;
  const double dx = x - surface->x_m;
  const double dy = y - surface->y_m;
  const double across = 1.0 / hit_stddev_m;
  const double off = beyond(surface->normal_x * dy - surface->normal_y * dx, surface->slack_m);
  const double along = off == 0.0 ? 0.0 : std::sqrt(surface->tangential) / hit_stddev_m;
  residual[0] = across * (surface->normal_x * dx + surface->normal_y * dy);
  residual[1] = along * off;
  if (jacobian != nullptr) {
    jacobian[0] = across * surface->normal_x;
    jacobian[1] = across * surface->normal_y;
    jacobian[2] = across * (surface->normal_y * rotated_x - surface->normal_x * rotated_y);
    jacobian[3] = -along * surface->normal_y;
    jacobian[4] = along * surface->normal_x;
    jacobian[5] = along * (surface->normal_x * rotated_x + surface->normal_y * rotated_y);
  }
  return true;
}

Pose2 match_with_ceres(const Endpoints& endpoints, const MatchField& field, const Pose2& guess,
                       const Pose2Gaussian& prior, const MatchConfig& config) {
  double pose[3] = {guess.x, guess.y, guess.theta};
  for (int level = config.levels - 1; level >= 0; --level) {
    const double sigma_m = config.hit_stddev_m * std::pow(2.0, level);
    ceres::Problem problem;
    for (std::size_t i = 0; i < endpoints.size(); ++i) {
      problem.AddResidualBlock(new BeamCost(endpoints.x_m[i], endpoints.y_m[i], field, sigma_m),
                               new MixtureLoss(config.hit_weight), pose);
    }
    problem.AddResidualBlock(new PriorCost(prior), nullptr, pose);
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_QR;
    options.num_threads = 1;
    options.max_num_iterations = config.max_iterations;
    options.function_tolerance = 1e-9;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
  }
  return {pose[0], pose[1], wrap_angle(pose[2])};
}

}  // namespace strata::registration
