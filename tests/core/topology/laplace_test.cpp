// SPDX-License-Identifier: Apache-2.0
/// By how much Laplace's method errs, against the integral by importance sampling.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "core/random/stream.hpp"
#include "core/topology/detail/descent.hpp"
#include "core/topology/detail/quadratic.hpp"
#include "core/topology/detail/row_order.hpp"
#include "core/topology/detail/terms.hpp"
#include "core/topology/topology_filter.hpp"
#include "tests/core/topology/reckoning.hpp"

namespace strata::topology {
namespace {

constexpr int kSamples = 20000;
constexpr int kFreedom =
    8;  // of Student's distribution, whose tails are wider than the integrand's

Eigen::MatrixXd covariance_of(const BlockFactor& factor) {
  const Eigen::Index size = 3 * static_cast<Eigen::Index>(factor.size());
  Eigen::MatrixXd covariance(size, size);
  for (int row = 0; row < factor.size(); ++row) {
    covariance.middleCols(3 * static_cast<Eigen::Index>(row), 3) = factor.inverse_of(row);
  }
  return 0.5 * (covariance + covariance.transpose());
}

std::vector<Pose2> moved(std::vector<Pose2> poses, const std::vector<int>& rows,
                         const Eigen::VectorXd& by) {
  for (std::size_t visit = 1; visit < poses.size(); ++visit) {
    const auto row = 3 * static_cast<Eigen::Index>(rows[visit]);
    poses[visit].x += by[row];
    poses[visit].y += by[row + 1];
    poses[visit].theta += by[row + 2];
  }
  return poses;
}

/// The logarithm of the integral of exp(cost at the optimum - cost), less what a Gaussian of this
/// covariance makes of it.
double beyond_gaussian(const detail::Terms& terms, const LocationPriorConfig& config,
                       const std::vector<Pose2>& optimum, const std::vector<int>& rows,
                       const Eigen::MatrixXd& covariance, RandomStream& random) {
  const Eigen::MatrixXd root = covariance.llt().matrixL();
  const auto size = static_cast<double>(root.rows());
  const double log_norm = std::lgamma(0.5 * (kFreedom + size)) - std::lgamma(0.5 * kFreedom) +
                          0.5 * size * std::log(2.0 / kFreedom);
  const double least = detail::cost_at(terms, optimum, config);
  std::vector<double> log_weights;
  for (int i = 0; i < kSamples; ++i) {
    Eigen::VectorXd drawn(root.rows());
    for (double& value : drawn) value = random.normal();
    double chi_squared = 0.0;
    for (int k = 0; k < kFreedom / 2; ++k) chi_squared += 2.0 * random.exponential(1.0);
    drawn *= std::sqrt(kFreedom / chi_squared);
    const double log_density =
        log_norm - 0.5 * (kFreedom + size) * std::log1p(drawn.squaredNorm() / kFreedom);
    const double cost = detail::cost_at(terms, moved(optimum, rows, root * drawn), config);
    log_weights.push_back(least - cost - log_density);
  }
  const double largest = *std::max_element(log_weights.begin(), log_weights.end());
  double sum = 0.0;
  for (const double weight : log_weights) sum += std::exp(weight - largest);
  return largest + std::log(sum / kSamples);
}

/// What a method says less what was sampled.
struct Errors {
  int count = 0;
  double sum = 0.0;
  double least = 0.0;
  double most = 0.0;
  void add(double error) {
    ++count;
    sum += error;
    least = std::min(least, error);
    most = std::max(most, error);
  }
  [[nodiscard]] double mean() const { return sum / count; }
};

/// Of the volume that `evaluate` takes, and of that by the exact curvature.
struct Compared {
  Errors taken;
  Errors exact;
  void add(const detail::Terms& terms, const LocationPriorConfig& config,
           const std::vector<Pose2>& optimum, const LocationGaussian& gaussian,
           RandomStream& random) {
    detail::NearPairs near(terms.landmarks, config.penalty_radius_m);
    const std::vector<int> rows =
        detail::rows_after(nullptr, detail::touching(terms, config, optimum, near), optimum.size());
    const auto factor =
        detail::quadratic_at(terms, config, optimum, rows, detail::Curvature::kExact, near)
            .factorize();
    if (!factor) return;
    const double beyond =
        beyond_gaussian(terms, config, optimum, rows, covariance_of(*factor), random);
    exact.add(-beyond);
    taken.add(0.5 * (factor->log_determinant() - gaussian.log_determinant()) - beyond);
  }
};

Compared of_squares(const Labels& labels) {
  const LocationPriorConfig config;
  RandomStream random(1, StreamId::kTest, 83);
  Compared errors;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const test_world::Reckoning way = test_world::small_square(seed);
    const detail::Terms terms = detail::collect(labels, way.first(7), {}, config);
    const auto optimum = detail::descend(terms, config, way.poses);
    if (optimum) errors.add(terms, config, optimum->poses, *optimum->gaussian, random);
  }
  return errors;
}

/// Of all topologies that are kept after 14 of 44 visits, no two of 40 junctions alike.
Compared of_drives() {
  const TopologyConfig config;
  RandomStream random(1, StreamId::kTest, 84);
  Compared errors;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    test_world::Drive drive = test_world::drive(test_world::unlike_rows_of_ten(40),
                                                test_world::row_by_row(40), config.odometry, seed);
    drive.visits.resize(14);
    const test_world::Reckoning way(drive);
    TopologyFilter filter(config, 1);
    for (LandmarkVisit& visit : drive.visits) filter.add(std::move(visit));
    for (const Hypothesis& hypothesis : filter.posterior()) {
      const detail::Terms terms =
          detail::collect(hypothesis.labels, way.first(14), hypothesis.scans, config.location);
      errors.add(terms, config.location, hypothesis.poses, *hypothesis.gaussian, random);
    }
  }
  return errors;
}

void record(const std::string& name, const Errors& errors) {
  testing::Test::RecordProperty(name + "_count", errors.count);
  testing::Test::RecordProperty(name + "_mean", std::to_string(errors.mean()));
  testing::Test::RecordProperty(name + "_least", std::to_string(errors.least));
  testing::Test::RecordProperty(name + "_most", std::to_string(errors.most));
}

/// Of small squares whose visits have these labels: both volumes err by less than that.
void expect_within(double most_nats, int least_count, const Labels& labels) {
  const Compared errors = of_squares(labels);
  record("taken", errors.taken);
  record("exact", errors.exact);
  EXPECT_GE(errors.taken.count, least_count);
  for (const Errors& of : {errors.taken, errors.exact}) {
    EXPECT_LT(std::max(of.most, -of.least), most_nats);
  }
}

// docs/theory/topological_mapping.md, "Evidence", has the figures: --gtest_output=xml tells them.
TEST(Laplace, IsRightToATenthOfANatWhereTheWayClosesAsMeasured) {
  expect_within(0.1, 20, {0, 1, 2, 3, 0, 1, 2});
}

TEST(Laplace, IsRightToTwoThirdsOfANatWhereLandmarksPressOnEachOther) {
  expect_within(0.67, 19, {0, 1, 2, 3, 4, 5, 6});
}

// The curvature taken leaves out how links bend, and of penalties all where it is indefinite.
TEST(Laplace, SaysTooMuchWhereTopologiesAreBentAndByTheExactCurvatureNot) {
  const Compared errors = of_drives();
  record("taken", errors.taken);
  record("exact", errors.exact);
  EXPECT_GE(errors.taken.count, 20);
  EXPECT_GT(errors.taken.mean(), 0.2);
  EXPECT_LT(errors.taken.most, 4.0);
  EXPECT_LT(std::abs(errors.exact.mean()), 0.2);
}

}  // namespace
}  // namespace strata::topology
