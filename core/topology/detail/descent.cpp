// SPDX-License-Identifier: Apache-2.0
#include "core/topology/detail/descent.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>

#include "core/geometry/angle.hpp"
#include "core/pose_graph/pose_graph.hpp"
#include "core/topology/location_prior.hpp"

namespace strata::topology::detail {
namespace {

constexpr int kMaxSteps = 30;
constexpr int kMaxHalvings = 8;
/// The cost cannot fall by more than this any longer [nats].
constexpr double kSettled = 1e-6;
/// A step that falls less than this share of the one before asks for a new factor.
constexpr double kSlow = 0.1;
/// Poses that have moved less, to each other, keep their curvature.
constexpr double kSameM = 0.01;
constexpr double kSameRad = 0.002;
/// Finding an order of rows takes as long as a factor; those of so many visits are put behind it
/// before another one is looked for.
constexpr std::size_t kOrderedVisits = 8;

enum class PenaltyCurvature { kTrue, kOfResidual, kNone };

/// Which two visits, neither of them the first, have a factor between them.
using Touching = std::vector<std::pair<std::size_t, std::size_t>>;

Touching touching(const Terms& terms, const LocationPriorConfig& config,
                  std::span<const Pose2> poses, NearPairs& near) {
  Touching pairs;
  pairs.reserve(terms.links.size() + terms.revisits.size());
  const auto touch = [&](std::size_t a, std::size_t b) {
    if (a > 0 && b > 0) pairs.emplace_back(a, b);
  };
  for (const Link& link : terms.links) touch(link.a, link.b);
  for (const Pair& pair : terms.revisits) touch(pair.a, pair.b);
  if (config.max_penalty > 0.0) {
    for (const Pair& pair : near.at(poses)) touch(pair.a, pair.b);
  }
  return pairs;
}

/// rows: of each visit.
BlockPattern pattern_of(const Touching& pairs, const std::vector<int>& rows) {
  std::vector<std::pair<int, int>> touching_rows;
  touching_rows.reserve(pairs.size());
  for (const auto& [a, b] : pairs) {
    touching_rows.emplace_back(std::max(rows[a], rows[b]), std::min(rows[a], rows[b]));
  }
  return BlockPattern(static_cast<int>(rows.size()) - 1, touching_rows);
}

/// Gradient and curvature of the cost by all poses but the first.
class Quadratic {
 public:
  /// rows: of each visit; pattern: nothing for the gradient alone.
  Quadratic(const std::vector<int>& rows, std::optional<BlockPattern> pattern)
      : rows_(rows),
        gradient_(Eigen::VectorXd::Zero(3 * (static_cast<Eigen::Index>(rows.size()) - 1))) {
    if (pattern) matrix_.emplace(std::move(*pattern));
  }
  [[nodiscard]] bool with_curvature() const { return matrix_.has_value(); }
  void add_gradient(std::size_t visit, const Eigen::Vector3d& by_pose) {
    if (visit > 0) gradient_.segment<3>(3 * static_cast<Eigen::Index>(rows_[visit])) += by_pose;
  }
  void add(std::size_t a, std::size_t b, const Eigen::Matrix3d& block) {
    if (a == 0 || b == 0 || rows_[a] < rows_[b]) return;
    matrix_->add(rows_[a], rows_[b], block);
  }
  /// Of the two positions: +block on their own, -block between them. block: symmetric.
  void add_apart(const Pair& pair, const Eigen::Matrix2d& block) {
    Eigen::Matrix3d whole = Eigen::Matrix3d::Zero();
    whole.topLeftCorner<2, 2>() = block;
    add(pair.a, pair.a, whole);
    add(pair.b, pair.b, whole);
    add(pair.a, pair.b, -whole);
    add(pair.b, pair.a, -whole);
  }
  [[nodiscard]] const Eigen::VectorXd& gradient() const { return gradient_; }
  /// The curvature is gone then.
  [[nodiscard]] std::unique_ptr<const BlockFactor> factorize() {
    return BlockFactor::of(std::move(*matrix_));
  }

 private:
  const std::vector<int>& rows_;
  std::optional<BlockMatrix> matrix_;
  Eigen::VectorXd gradient_;
};

void add_links(const Terms& terms, std::span<const Pose2> poses, Quadratic& quadratic) {
  for (const Link& link : terms.links) {
    Eigen::Matrix3d by_a;
    Eigen::Matrix3d by_b;
    const Eigen::Vector3d error =
        pose_graph::edge_error(poses[link.a], poses[link.b], link.a_from_b, &by_a, &by_b);
    const Eigen::Vector3d weighted = link.information * error;
    quadratic.add_gradient(link.a, by_a.transpose() * weighted);
    quadratic.add_gradient(link.b, by_b.transpose() * weighted);
    if (!quadratic.with_curvature()) continue;
    const Eigen::Matrix3d weighted_a = link.information * by_a;
    const Eigen::Matrix3d weighted_b = link.information * by_b;
    quadratic.add(link.a, link.a, by_a.transpose() * weighted_a);
    quadratic.add(link.b, link.b, by_b.transpose() * weighted_b);
    quadratic.add(link.a, link.b, by_a.transpose() * weighted_b);
    quadratic.add(link.b, link.a, by_b.transpose() * weighted_a);
  }
}

void add_revisits(const Terms& terms, std::span<const Pose2> poses,
                  const LocationPriorConfig& config, Quadratic& quadratic) {
  const double information = 1.0 / (config.revisit_stddev_m * config.revisit_stddev_m);
  for (const Pair& pair : terms.revisits) {
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    gradient.head<2>() = information * (poses[pair.b].translation() - poses[pair.a].translation());
    quadratic.add_gradient(pair.b, gradient);
    quadratic.add_gradient(pair.a, -gradient);
    if (!quadratic.with_curvature()) continue;
    quadratic.add_apart(pair, information * Eigen::Matrix2d::Identity());
  }
}

Eigen::Matrix2d curvature_of(const Penalty& penalty, const Eigen::Vector2d& apart,
                             PenaltyCurvature curvature) {
  const double distance_m = apart.norm();
  if (distance_m < 1e-6) {
    if (curvature == PenaltyCurvature::kOfResidual) return Eigen::Matrix2d::Zero();
    return penalty.curve * Eigen::Matrix2d::Identity();
  }
  const Eigen::Vector2d along = apart / distance_m;
  const Eigen::Matrix2d radial = along * along.transpose();
  if (curvature == PenaltyCurvature::kOfResidual) {
    return 0.5 * penalty.slope * penalty.slope / penalty.value * radial;
  }
  return penalty.curve * radial +
         penalty.slope / distance_m * (Eigen::Matrix2d::Identity() - radial);
}

void add_penalties(std::span<const Pose2> poses, const LocationPriorConfig& config,
                   PenaltyCurvature curvature, NearPairs& near, Quadratic& quadratic) {
  if (config.max_penalty <= 0.0) return;
  for (const Pair& pair : near.at(poses)) {
    const Eigen::Vector2d apart = poses[pair.b].translation() - poses[pair.a].translation();
    const Penalty penalty = penalty_at(apart.norm(), config);
    if (!(penalty.value > 0.0)) continue;
    Eigen::Vector3d push = Eigen::Vector3d::Zero();
    if (apart.norm() > 0.0) push.head<2>() = penalty.slope * apart.normalized();
    quadratic.add_gradient(pair.b, push);
    quadratic.add_gradient(pair.a, -push);
    if (quadratic.with_curvature() && curvature != PenaltyCurvature::kNone) {
      quadratic.add_apart(pair, curvature_of(penalty, apart, curvature));
    }
  }
}

/// Few fill-ins: minimum degree, by whole poses.
std::vector<int> ordered_rows(const Touching& pairs, std::size_t visits) {
  const auto size = static_cast<int>(visits) - 1;
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(visits + 2 * pairs.size());
  for (int i = 0; i < size; ++i) entries.emplace_back(i, i, 1.0);
  for (const auto& [a, b] : pairs) {
    entries.emplace_back(static_cast<int>(a) - 1, static_cast<int>(b) - 1, 1.0);
    entries.emplace_back(static_cast<int>(b) - 1, static_cast<int>(a) - 1, 1.0);
  }
  Eigen::SparseMatrix<double> pattern(size, size);
  pattern.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(pattern, order);
  std::vector<int> rows(visits, 0);
  for (int i = 0; i < size; ++i) rows[static_cast<std::size_t>(order.indices()[i]) + 1] = i;
  return rows;
}

/// The rows of `before`, the newest visit behind them; from time to time, by the number of visits
/// alone, or where there is nothing before, those of fewest fill-ins.
std::vector<int> rows_after(const LocationGaussian* before, const Touching& pairs,
                            std::size_t visits) {
  if (before == nullptr || before->rows().size() + 1 != visits || visits % kOrderedVisits == 0) {
    return ordered_rows(pairs, visits);
  }
  std::vector<int> rows = before->rows();
  rows.push_back(static_cast<int>(visits) - 2);
  return rows;
}

void add_terms(const Terms& terms, const LocationPriorConfig& config, std::span<const Pose2> poses,
               PenaltyCurvature curvature, NearPairs& near, Quadratic& quadratic) {
  add_links(terms, poses, quadratic);
  add_revisits(terms, poses, config, quadratic);
  add_penalties(poses, config, curvature, near, quadratic);
}

Eigen::VectorXd gradient_at(const Terms& terms, const LocationPriorConfig& config,
                            std::span<const Pose2> poses, const std::vector<int>& rows,
                            NearPairs& near) {
  Quadratic quadratic(rows, std::nullopt);
  add_terms(terms, config, poses, PenaltyCurvature::kNone, near, quadratic);
  return quadratic.gradient();
}

Quadratic quadratic_at(const Terms& terms, const LocationPriorConfig& config,
                       std::span<const Pose2> poses, const std::vector<int>& rows,
                       PenaltyCurvature curvature, NearPairs& near) {
  Quadratic quadratic(rows, pattern_of(touching(terms, config, poses, near), rows));
  add_terms(terms, config, poses, curvature, near, quadratic);
  return quadratic;
}

std::vector<Pose2> moved(std::span<const Pose2> poses, const std::vector<int>& rows,
                         const Eigen::VectorXd& step, double share) {
  std::vector<Pose2> result(poses.begin(), poses.end());
  for (std::size_t i = 1; i < result.size(); ++i) {
    const Eigen::Vector3d by = share * step.segment<3>(3 * static_cast<Eigen::Index>(rows[i]));
    result[i] = {result[i].x + by.x(), result[i].y + by.y(), wrap_angle(result[i].theta + by.z())};
  }
  return result;
}

/// Goes along the step as far as the cost falls; false when it does not.
bool go(const Terms& terms, const LocationPriorConfig& config, const std::vector<int>& rows,
        const Eigen::VectorXd& step, NearPairs& near, Optimum& at) {
  double share = 1.0;
  for (int i = 0; i < kMaxHalvings; ++i, share *= 0.5) {
    std::vector<Pose2> poses = moved(at.poses, rows, step, share);
    const double cost = cost_at(terms, poses, config, near);
    if (!(cost < at.cost)) continue;
    at.poses = std::move(poses);
    at.cost = cost;
    return true;
  }
  return false;
}

/// A factor and the poses where it was made, with the gradient there.
struct Linearized {
  std::unique_ptr<const BlockFactor> factor;
  bool true_curvature = true;
  std::vector<Pose2> poses;
  Eigen::VectorXd gradient;
};

Linearized linearize(const Terms& terms, const LocationPriorConfig& config,
                     std::span<const Pose2> poses, const std::vector<int>& rows, NearPairs& near) {
  Linearized linearized{nullptr, true, {poses.begin(), poses.end()}, {}};
  for (const PenaltyCurvature curvature :
       {PenaltyCurvature::kTrue, PenaltyCurvature::kOfResidual}) {
    Quadratic quadratic = quadratic_at(terms, config, poses, rows, curvature, near);
    linearized.gradient = quadratic.gradient();
    linearized.true_curvature = curvature == PenaltyCurvature::kTrue;
    linearized.factor = quadratic.factorize();
    if (linearized.factor) return linearized;
  }
  return linearized;
}

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

}  // namespace

std::shared_ptr<const LocationGaussian> gaussian_at(const Terms& terms,
                                                    const LocationPriorConfig& config,
                                                    std::span<const Pose2> poses) {
  NearPairs near(terms.landmarks, config.penalty_radius_m);
  const std::vector<int> rows = ordered_rows(touching(terms, config, poses, near), poses.size());
  for (const PenaltyCurvature curvature : {PenaltyCurvature::kTrue, PenaltyCurvature::kNone}) {
    if (auto factor = quadratic_at(terms, config, poses, rows, curvature, near).factorize()) {
      return std::make_shared<const LocationGaussian>(std::move(factor), rows);
    }
  }
  return nullptr;
}

/// A factor serves as long as the cost falls well with it; the last one must be made near the end.
std::optional<Optimum> descend(const Terms& terms, const LocationPriorConfig& config,
                               std::vector<Pose2> start, const LocationGaussian* before) {
  Optimum at{std::move(start), 0.0, nullptr};
  NearPairs near(terms.landmarks, config.penalty_radius_m);
  at.cost = cost_at(terms, at.poses, config, near);
  if (!std::isfinite(at.cost)) return std::nullopt;
  const std::vector<int> rows =
      rows_after(before, touching(terms, config, at.poses, near), at.poses.size());
  Linearized linearized = linearize(terms, config, at.poses, rows, near);
  double last_fall = std::numeric_limits<double>::infinity();
  bool is_new = true;  // the factor is that of here
  for (int i = 0; i < kMaxSteps; ++i) {
    if (!linearized.factor) return std::nullopt;
    const Eigen::VectorXd gradient =
        is_new ? linearized.gradient : gradient_at(terms, config, at.poses, rows, near);
    Eigen::VectorXd step = -gradient;
    linearized.factor->solve(step);
    const double fall = -0.5 * gradient.dot(step);
    const bool here = still_holds(terms, config, linearized, at.poses, near);
    if (fall < kSettled && here) {
      at.poses = moved(at.poses, rows, step, 1.0);
      at.cost -= fall;
      at.gaussian = linearized.true_curvature ? std::make_shared<const LocationGaussian>(
                                                    std::move(linearized.factor), rows)
                                              : gaussian_at(terms, config, at.poses);
      if (!at.gaussian) return std::nullopt;
      return at;
    }
    if (!here && (fall < kSettled || fall > kSlow * last_fall)) {
      linearized = linearize(terms, config, at.poses, rows, near);
      last_fall = std::numeric_limits<double>::infinity();
      is_new = true;
      continue;
    }
    last_fall = fall;
    is_new = false;
    if (go(terms, config, rows, step, near, at)) continue;
    if (here) return std::nullopt;
    linearized = linearize(terms, config, at.poses, rows, near);
    is_new = true;
  }
  return std::nullopt;
}

}  // namespace strata::topology::detail
