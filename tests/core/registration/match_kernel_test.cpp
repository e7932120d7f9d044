// SPDX-License-Identifier: Apache-2.0
#include "core/registration/match_kernel.hpp"

#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "core/random/stream.hpp"
#include "tests/support/every_target.hpp"

namespace strata::registration {
namespace {

constexpr double kHitStddev_m = 0.1;
constexpr double kHitWeight = 0.9;

/// Surfaces of every kind, some no longer there.
MatchField some_field(RandomStream& random) {
  MatchField field(0.05);
  for (int i = 0; i < 400; ++i) {
    SurfacePoint point;
    point.x_m = random.uniform(-4.0, 4.0);
    point.y_m = random.uniform(-3.0, 3.0);
    const double angle = random.uniform(-3.1, 3.1);
    point.normal_x = std::cos(angle);
    point.normal_y = std::sin(angle);
    point.tangential = i % 3 == 0 ? 1.0 : random.uniform(0.02, 1.0);
    point.slack_m = i % 5 == 0   ? std::numeric_limits<double>::infinity()
                    : i % 2 == 0 ? random.uniform(0.0, 0.1)
                                 : 0.0;
    const std::size_t index = field.add(point);
    if (i % 11 == 0) field.hide(index);
  }
  return field;
}

/// Some within reach of a surface, some not, some outside the field.
Endpoints some_endpoints(RandomStream& random, std::size_t count) {
  Endpoints endpoints;
  for (std::size_t i = 0; i < count; ++i) {
    endpoints.x_m.push_back(random.uniform(-8.0, 8.0));
    endpoints.y_m.push_back(random.uniform(-5.0, 5.0));
    endpoints.beam.push_back(static_cast<std::uint32_t>(2 * i));
  }
  return endpoints;
}

/// The sums beam by beam, with the standard library's functions.
MatchSums slow_sums(const Endpoints& endpoints, const std::vector<float>& weights,
                    const MatchField& field, const Pose2& pose) {
  MatchSums sums;
  const double c = std::cos(pose.theta);
  const double s = std::sin(pose.theta);
  for (std::size_t i = 0; i < endpoints.size(); ++i) {
    const double e = weights.empty() ? 1.0 : static_cast<double>(weights[endpoints.beam[i]]);
    const double rx = c * endpoints.x_m[i] - s * endpoints.y_m[i];
    const double ry = s * endpoints.x_m[i] + c * endpoints.y_m[i];
    sums.weight += e;
    const SurfacePoint* p = field.nearest(pose.x + rx, pose.y + ry);
    if (p == nullptr) {
      sums.log_mixture += e * std::log(1.0 - kHitWeight);
      continue;
    }
    const double across =
        p->normal_x * (pose.x + rx - p->x_m) + p->normal_y * (pose.y + ry - p->y_m);
    const double along = beyond(
        p->normal_x * (pose.y + ry - p->y_m) - p->normal_y * (pose.x + rx - p->x_m), p->slack_m);
    const double iv = 1.0 / (kHitStddev_m * kHitStddev_m);
    const double kernel = std::exp(-0.5 * iv * (across * across + p->tangential * along * along));
    const double mixture = kHitWeight * kernel + 1.0 - kHitWeight;
    sums.inlier_weight += e * kernel;
    sums.log_mixture += e * std::log(mixture);
    const double w = e * iv * kHitWeight * kernel / mixture;
    const double wl = along == 0.0 ? 0.0 : w * p->tangential;
    const double ja[3] = {p->normal_x, p->normal_y, p->normal_y * rx - p->normal_x * ry};
    const double jl[3] = {-p->normal_y, p->normal_x, p->normal_x * rx + p->normal_y * ry};
    std::size_t k = 0;
    for (const auto& [row, column] : {std::pair(0, 0), {0, 1}, {1, 1}, {0, 2}, {1, 2}, {2, 2}}) {
      sums.hessian[k++] += w * ja[row] * ja[column] + wl * jl[row] * jl[column];
    }
    for (int row = 0; row < 3; ++row) {
      sums.gradient[row] += w * ja[row] * across + wl * jl[row] * along;
    }
  }
  return sums;
}

void expect_near(const MatchSums& one, const MatchSums& other) {
  const auto near = [](double a, double b) {
    EXPECT_NEAR(a, b, 1e-11 * (1.0 + std::abs(a) + std::abs(b)));
  };
  near(one.weight, other.weight);
  near(one.inlier_weight, other.inlier_weight);
  near(one.log_mixture, other.log_mixture);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(one.gradient[k], other.gradient[k], 1e-7);
  for (int k = 0; k < 6; ++k) EXPECT_NEAR(one.hessian[k], other.hessian[k], 1e-6);
}

TEST(MatchKernel, SumsEqualThoseBeamByBeamForAnyNumberOfBeamsAndWeights) {
  RandomStream random(1, StreamId::kTest);
  for (int round = 0; round < 60; ++round) {
    const MatchField field = some_field(random);
    const Endpoints endpoints = some_endpoints(random, static_cast<std::size_t>(round * 7));
    std::vector<float> weights;
    for (std::size_t i = 0; i < 2 * endpoints.size() && round % 2 == 0; ++i) {
      weights.push_back(static_cast<float>(random.uniform(0.0, 1.0)));
    }
    const Pose2 pose{random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0),
                     random.uniform(-3.1, 3.1)};
    expect_near(
        sum_match(MatchBeams(endpoints, weights), field, pose, kHitStddev_m, kHitWeight, true),
        slow_sums(endpoints, weights, field, pose));
  }
}

TEST(MatchKernel, GivesTheSameBitsOnEveryTargetWithAndWithoutDerivatives) {
  RandomStream random(2, StreamId::kTest);
  const MatchField field = some_field(random);
  const MatchBeams beams(some_endpoints(random, 361), {});
  const auto sums = [&](bool derivatives) {
    return sum_match(beams, field, {0.1, -0.2, 0.7}, kHitStddev_m, kHitWeight, derivatives);
  };
  const MatchSums here = sums(true);
  EXPECT_LT(here.log_mixture, 0.0);
  test::for_every_target([&] {
    const MatchSums there = sums(true);
    EXPECT_EQ(std::memcmp(&here, &there, sizeof(MatchSums)), 0);
    const MatchSums cost_alone = sums(false);
    EXPECT_EQ(cost_alone.log_mixture, here.log_mixture);
    EXPECT_EQ(cost_alone.inlier_weight, here.inlier_weight);
  });
}

}  // namespace
}  // namespace strata::registration
