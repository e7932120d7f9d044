// SPDX-License-Identifier: Apache-2.0
#include "core/topology/detail/descent.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <utility>

#include "core/geometry/angle.hpp"
#include "core/topology/detail/quadratic.hpp"
#include "core/topology/detail/row_order.hpp"

namespace strata::topology::detail {
namespace {

constexpr int kMaxSteps = 100;
/// Of a step, and of the fall that it promises.
constexpr double kLeastShare = 1e-3;
constexpr double kMostShare = 1e3;
/// The cost cannot fall by more than this any longer [nats].
constexpr double kSettled = 1e-6;
/// Where steps promise less than this, the nearest minimum is the one wanted [nats].
constexpr double kNear = 1e-2;
/// Of the diagonal, at first; times the growth, that itself grows so, after a step in vain.
constexpr double kDamping = 1e-4;
constexpr double kDampingGrowth = 2.0;
/// A step that falls less than this share of the one before asks for a new factor.
constexpr double kSlow = 0.1;
/// Poses that have moved less, to each other, keep their curvature.
constexpr double kSameM = 0.01;
constexpr double kSameRad = 0.002;

std::vector<Pose2> moved(std::span<const Pose2> poses, const std::vector<int>& rows,
                         const Eigen::VectorXd& step, double share) {
  std::vector<Pose2> result(poses.begin(), poses.end());
  for (std::size_t i = 1; i < result.size(); ++i) {
    const Eigen::Vector3d by = share * step.segment<3>(3 * static_cast<Eigen::Index>(rows[i]));
    result[i] = {result[i].x + by.x(), result[i].y + by.y(), wrap_angle(result[i].theta + by.z())};
  }
  return result;
}

/// A factor and the poses where it was made, with the gradient there.
struct Linearized {
  std::unique_ptr<const BlockFactor> factor;
  Curvature curvature = Curvature::kGaussian;
  std::vector<Pose2> poses;
  Eigen::VectorXd gradient;
};

/// Whether two poses lie as they did to each other.
bool lie_as_then(std::size_t a, std::size_t b, std::span<const Pose2> then,
                 std::span<const Pose2> now) {
  return std::abs((now[b].x - now[a].x) - (then[b].x - then[a].x)) <= kSameM &&
         std::abs((now[b].y - now[a].y) - (then[b].y - then[a].y)) <= kSameM;
}

/// Whether the curvature is still about that of where the factor was made. It depends on headings
/// and on where poses lie to each other: a part of the map that is shifted as a whole keeps it.
bool still_holds(const Terms& terms, const LocationPriorConfig& config,
                 const Linearized& linearized, std::span<const Pose2> poses, NearPairs& near) {
  const std::span<const Pose2> then = linearized.poses;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    if (std::abs(angle_difference(poses[i].theta, then[i].theta)) > kSameRad) return false;
  }
  const auto lie_so = [&](const auto& pair) { return lie_as_then(pair.a, pair.b, then, poses); };
  if (!std::all_of(terms.links.begin(), terms.links.end(), lie_so)) return false;
  if (config.max_penalty <= 0.0) return true;
  const std::span<const Pair> near_now = near.at(poses);
  if (!std::all_of(near_now.begin(), near_now.end(), lie_so)) return false;
  const std::span<const Pair> near_then = near.at(then);
  return std::all_of(near_then.begin(), near_then.end(), lie_so);
}

/// One descent, from a factor to the next.
class Descent {
 public:
  Descent(const Terms& terms, const LocationPriorConfig& config, std::vector<Pose2> start,
          const LocationGaussian* before)
      : terms_(terms),
        config_(config),
        near_(terms.landmarks, config.penalty_radius_m),
        at_{std::move(start), 0.0, nullptr},
        rows_(rows_after(before, touching(terms, config, at_.poses, near_), at_.poses.size())) {
    at_.cost = cost_at(terms, at_.poses, config, near_);
  }

  /// Whether the least cost nearby is found.
  [[nodiscard]] bool run();
  [[nodiscard]] Optimum take() { return std::move(at_); }

 private:
  /// With the first of these curvatures that is positive definite.
  void linearize(std::initializer_list<Curvature> curvatures);
  /// Into the valley of the start.
  void approach();
  /// Goes along the step as far as the cost falls; false when it does not.
  bool go(const Eigen::VectorXd& step);
  /// At the end: goes the last step, which falls by so much.
  bool settle(const Eigen::VectorXd& step, double fall);
  [[nodiscard]] bool is_of_here() {
    return is_new_ || still_holds(terms_, config_, linearized_, at_.poses, near_);
  }

  const Terms& terms_;
  const LocationPriorConfig& config_;
  NearPairs near_;
  Optimum at_;
  std::vector<int> rows_;
  Linearized linearized_;
  bool is_new_ = false;  // the factor is that of here
};

void Descent::linearize(std::initializer_list<Curvature> curvatures) {
  linearized_ = {nullptr, Curvature::kGaussian, at_.poses, {}};
  for (const Curvature curvature : curvatures) {
    Quadratic quadratic = quadratic_at(terms_, config_, at_.poses, rows_, curvature, near_);
    linearized_.curvature = curvature;
    linearized_.gradient = quadratic.gradient();
    linearized_.factor = quadratic.factorize();
    if (linearized_.factor) break;
  }
  is_new_ = true;
}

bool Descent::go(const Eigen::VectorXd& step) {
  is_new_ = false;
  const std::vector<Pose2> from = at_.poses;
  const auto falls_by = [&](double share) {
    std::vector<Pose2> poses = moved(from, rows_, step, share);
    const double cost = cost_at(terms_, poses, config_, near_);
    if (!(cost < at_.cost)) return false;
    at_.poses = std::move(poses);
    at_.cost = cost;
    return true;
  };
  if (falls_by(1.0)) {
    // Where too much curvature was counted the cost falls on behind the step.
    bool goes_on = linearized_.curvature == Curvature::kPositive;
    for (double share = 2.0; goes_on && share < kMostShare; share *= 2.0) goes_on = falls_by(share);
    return true;
  }
  for (double share = 0.5; share > kLeastShare; share *= 0.5) {
    if (falls_by(share)) return true;
  }
  return false;
}

bool Descent::settle(const Eigen::VectorXd& step, double fall) {
  at_.poses = moved(at_.poses, rows_, step, 1.0);
  at_.cost -= fall;
  if (linearized_.curvature != Curvature::kGaussian) {
    linearize({Curvature::kGaussian, Curvature::kLinks});
    if (!linearized_.factor) return false;
  }
  at_.gaussian = std::make_shared<const LocationGaussian>(std::move(linearized_.factor), rows_);
  return true;
}

/// Levenberg and Marquardt's way with the damping of Ceres, to rest in the same minimum: from where
/// the curvature is indefinite, long steps by it would lead over ridges.
void Descent::approach() {
  double damping = kDamping;
  double growth = kDampingGrowth;
  for (int i = 0; i < kMaxSteps; ++i) {
    Quadratic quadratic = quadratic_at(terms_, config_, at_.poses, rows_, Curvature::kRoots, near_);
    const Eigen::VectorXd gradient = quadratic.gradient();
    quadratic.damp(damping);
    const auto factor = quadratic.factorize();
    if (!factor) return;
    Eigen::VectorXd step = -gradient;
    factor->solve(step);
    const double promised = -0.5 * gradient.dot(step);
    if (promised < kNear) return;
    std::vector<Pose2> poses = moved(at_.poses, rows_, step, 1.0);
    const double cost = cost_at(terms_, poses, config_, near_);
    const double share = (at_.cost - cost) / promised;
    if (share > kLeastShare) {
      at_.poses = std::move(poses);
      at_.cost = cost;
      damping *= std::max(1.0 / 3.0, 1.0 - std::pow(2.0 * share - 1.0, 3));
      growth = kDampingGrowth;
    } else {
      damping *= growth;
      growth *= kDampingGrowth;
    }
  }
}

/// A factor serves as long as the cost falls well with it. Where it does not, the exact curvature
/// tells how far to go, if it is positive. The Gaussian is that of the end.
bool Descent::run() {
  if (!std::isfinite(at_.cost)) return false;
  linearize({Curvature::kGaussian});
  if (!linearized_.factor) {
    approach();
    linearize({Curvature::kGaussian, Curvature::kExact, Curvature::kPositive});
  }
  double last_fall = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kMaxSteps && linearized_.factor; ++i) {
    const Eigen::VectorXd gradient =
        is_new_ ? linearized_.gradient : gradient_at(terms_, config_, at_.poses, rows_, near_);
    Eigen::VectorXd step = -gradient;
    linearized_.factor->solve(step);
    const double fall = -0.5 * gradient.dot(step);
    const Curvature curvature = linearized_.curvature;
    if (fall < kSettled && (curvature != Curvature::kGaussian || is_of_here())) {
      return settle(step, fall);
    }
    const bool is_slow = fall > kSlow * last_fall;
    const bool was_new = is_new_;
    last_fall = fall;
    const bool falls = fall >= kSettled && (was_new || !is_slow) && go(step);
    if (falls && curvature != Curvature::kPositive) continue;
    last_fall = std::numeric_limits<double>::infinity();
    if (fall < kSettled) {
      linearize({Curvature::kGaussian, Curvature::kExact, Curvature::kPositive});
    } else if (falls || !was_new || curvature == Curvature::kGaussian) {
      linearize({Curvature::kExact, Curvature::kPositive});
    } else if (curvature == Curvature::kExact) {
      linearize({Curvature::kPositive});
    } else {
      return false;
    }
  }
  return false;
}

}  // namespace

std::shared_ptr<const LocationGaussian> gaussian_at(const Terms& terms,
                                                    const LocationPriorConfig& config,
                                                    std::span<const Pose2> poses) {
  NearPairs near(terms.landmarks, config.penalty_radius_m);
  const std::vector<int> rows =
      rows_after(nullptr, touching(terms, config, poses, near), poses.size());
  for (const Curvature curvature : {Curvature::kGaussian, Curvature::kLinks}) {
    if (auto factor = quadratic_at(terms, config, poses, rows, curvature, near).factorize()) {
      return std::make_shared<const LocationGaussian>(std::move(factor), rows);
    }
  }
  return nullptr;
}

std::optional<Optimum> descend(const Terms& terms, const LocationPriorConfig& config,
                               std::vector<Pose2> start, const LocationGaussian* before) {
  Descent descent(terms, config, std::move(start), before);
  if (!descent.run()) return std::nullopt;
  return descent.take();
}

}  // namespace strata::topology::detail
