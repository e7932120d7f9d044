// SPDX-License-Identifier: Apache-2.0
#include "core/localization/particle_kernels.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "core/geometry/angle.hpp"
#include "core/localization/motion_kernel.hpp"
#include "core/localization/particle_set.hpp"
#include "core/random/stream_key.hpp"
#include "tests/support/every_target.hpp"

namespace strata::localization {
namespace {

using test::for_every_target;

/// Poses all over the place, weights of many magnitudes. 77 is no multiple of any vector.
ParticleSet some_particles(std::size_t count = 77) {
  RandomStream random(5, StreamId::kTest);
  ParticleSet particles;
  particles.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    particles.set_pose(
        i, {random.uniform(-50.0, 50.0), random.uniform(-50.0, 50.0), random.uniform(-3.14, 3.14)});
    particles.weight[i] = i % 9 == 0 ? 0.0 : std::exp(random.uniform(-30.0, 0.0));
  }
  return particles;
}

WeighedPoses view(const ParticleSet& p) {
  return {p.x_m.data(), p.y_m.data(), p.theta_rad.data(), p.weight.data(), p.size()};
}

MotionDraw some_draw() {
  MotionDraw draw;
  draw.back = {-0.1, 0.02, 0.3};
  draw.rotation1_rad = 0.2;
  draw.translation_m = 0.5;
  draw.rotation2_rad = -3.0;
  draw.rotation1_stddev_rad = 0.1;
  draw.translation_stddev_m = 0.07;
  draw.across_stddev_m = 0.03;
  draw.rotation2_stddev_rad = 0.2;
  draw.key = stream_key(7, StreamId::kMotion);
  draw.step = (std::uint64_t{3} << 32U) + 11;
  return draw;
}

/// The same with the standard library, one particle at a time.
Pose2 slow_draw(const MotionDraw& draw, std::uint32_t i, const Pose2& pose) {
  const auto block = philox4x32_10(
      {0, i, static_cast<std::uint32_t>(draw.step), static_cast<std::uint32_t>(draw.step >> 32U)},
      draw.key);
  double n[4];
  for (std::size_t pair = 0; pair < 2; ++pair) {
    const double u = (static_cast<double>(block[2 * pair]) + 0.5) * 0x1p-32;
    const double angle =
        2.0 * std::numbers::pi * static_cast<double>(block[2 * pair + 1]) * 0x1p-32;
    n[2 * pair] = std::sqrt(-2.0 * std::log(u)) * std::cos(angle);
    n[2 * pair + 1] = std::sqrt(-2.0 * std::log(u)) * std::sin(angle);
  }
  const Pose2 turn{0.0, 0.0, draw.rotation1_rad + draw.rotation1_stddev_rad * n[0]};
  const Pose2 go{draw.translation_m + draw.translation_stddev_m * n[1], draw.across_stddev_m * n[2],
                 draw.rotation2_rad + draw.rotation2_stddev_rad * n[3]};
  return pose * draw.back * turn * go;
}

TEST(MotionKernel, EveryTargetDrawsTheSameBitsNearThoseOfTheStandardLibrary) {
  const MotionDraw draw = some_draw();
  const ParticleSet before = some_particles();
  std::vector<ParticleSet> sets;
  for_every_target([&] {
    ParticleSet particles = before;
    draw_motions(
        draw, 1000,
        {particles.x_m.data(), particles.y_m.data(), particles.theta_rad.data(), particles.size()});
    for (std::size_t i = 0; i < particles.size(); ++i) {
      const Pose2 expected = slow_draw(draw, static_cast<std::uint32_t>(1000 + i), before.pose(i));
      EXPECT_NEAR(particles.x_m[i], expected.x, 1e-13);
      EXPECT_NEAR(particles.y_m[i], expected.y, 1e-13);
      EXPECT_NEAR(angle_difference(particles.theta_rad[i], expected.theta), 0.0, 1e-14);
      EXPECT_LE(std::abs(particles.theta_rad[i]), std::numbers::pi);
    }
    sets.push_back(std::move(particles));
    EXPECT_EQ(sets.back().x_m, sets.front().x_m);
    EXPECT_EQ(sets.back().y_m, sets.front().y_m);
    EXPECT_EQ(sets.back().theta_rad, sets.front().theta_rad);
  });
}

TEST(MotionKernel, EveryTargetMovesToTheSameBitsNearThePosesComposed) {
  const Pose2 motion{0.07, -0.02, 3.0};
  const ParticleSet before = some_particles();
  std::vector<ParticleSet> sets;
  for_every_target([&] {
    ParticleSet moved = before;
    move_poses(motion, {moved.x_m.data(), moved.y_m.data(), moved.theta_rad.data(), moved.size()});
    for (std::size_t i = 0; i < moved.size(); ++i) {
      const Pose2 expected = before.pose(i) * motion;
      EXPECT_NEAR(moved.x_m[i], expected.x, 1e-14 * std::max(1.0, std::abs(expected.x)));
      EXPECT_NEAR(moved.y_m[i], expected.y, 1e-14 * std::max(1.0, std::abs(expected.y)));
      EXPECT_NEAR(angle_difference(moved.theta_rad[i], expected.theta), 0.0, 1e-14);
    }
    sets.push_back(std::move(moved));
    EXPECT_EQ(sets.back().x_m, sets.front().x_m);
    EXPECT_EQ(sets.back().y_m, sets.front().y_m);
    EXPECT_EQ(sets.back().theta_rad, sets.front().theta_rad);
  });
}

TEST(MotionKernel, AParticleDrawsTheSameWhereverItsChunkBegins) {
  const MotionDraw draw = some_draw();
  ParticleSet whole = some_particles();
  ParticleSet parts = whole;
  draw_motions(draw, 0, {whole.x_m.data(), whole.y_m.data(), whole.theta_rad.data(), 77});
  for (const std::size_t begin : {std::size_t{0}, std::size_t{3}, std::size_t{40}}) {
    const std::size_t end = begin == 0 ? 3 : (begin == 3 ? 40 : 77);
    draw_motions(draw, begin,
                 {parts.x_m.data() + begin, parts.y_m.data() + begin,
                  parts.theta_rad.data() + begin, end - begin});
  }
  EXPECT_EQ(whole.x_m, parts.x_m);
  EXPECT_EQ(whole.theta_rad, parts.theta_rad);
}

TEST(MotionKernel, NormalsHaveTheMomentsAndTheTailOfANormal) {
  MotionDraw draw;
  draw.translation_stddev_m = draw.across_stddev_m = 1.0;
  draw.key = stream_key(3, StreamId::kMotion);
  const std::size_t count = 400000;
  ParticleSet p;
  p.resize(count);
  draw_motions(draw, 0, {p.x_m.data(), p.y_m.data(), p.theta_rad.data(), count});
  double mean = 0.0;
  double square = 0.0;
  double fourth = 0.0;
  double mixed = 0.0;
  double tail = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    mean += p.x_m[i] / count;
    square += p.x_m[i] * p.x_m[i] / count;
    fourth += std::pow(p.y_m[i], 4) / count;
    mixed += p.x_m[i] * p.y_m[i] / count;
    tail += std::abs(p.y_m[i]) > 3.0 ? 1.0 / count : 0.0;
  }
  EXPECT_NEAR(mean, 0.0, 0.007);
  EXPECT_NEAR(square, 1.0, 0.01);
  EXPECT_NEAR(fourth, 3.0, 0.07);
  EXPECT_NEAR(mixed, 0.0, 0.007);
  EXPECT_NEAR(tail, 0.0026998, 0.0004);
}

TEST(ParticleKernels, EveryTargetWeighsAlikeAndAsThePlainLoop) {
  const ParticleSet before = some_particles();
  RandomStream random(6, StreamId::kTest);
  std::vector<double> log(before.size());
  for (double& l : log) l = random.uniform(-900.0, -10.0);
  log[1] = std::numeric_limits<double>::quiet_NaN();
  log[2] = -std::numeric_limits<double>::infinity();
  log[9] = 500.0;  // weight 0: counts for nothing
  double greatest = -1e300;
  for (std::size_t i = 0; i < log.size(); ++i) {
    if (before.weight[i] > 0.0 && log[i] > greatest) greatest = log[i];
  }
  std::vector<std::vector<double>> all;
  std::vector<double> sums;
  for_every_target([&] {
    EXPECT_EQ(greatest_log(before.weight.data(), log.data(), log.size()), greatest);
    std::vector<double> weight = before.weight;
    const double sum = multiply_weights(log.data(), greatest, weight.data(), weight.size());
    double expected_sum = 0.0;
    for (std::size_t i = 0; i < weight.size(); ++i) {
      const double expected = log[i] >= greatest - 700.0 && before.weight[i] > 0.0
                                  ? before.weight[i] * std::exp(log[i] - greatest)
                                  : 0.0;
      EXPECT_NEAR(weight[i], expected, 1e-14 * expected) << i;
      expected_sum += expected;
    }
    EXPECT_NEAR(sum, expected_sum, 1e-14 * expected_sum);
    all.push_back(weight);
    sums.push_back(sum);
    EXPECT_EQ(all.back(), all.front());
    EXPECT_EQ(sums.back(), sums.front());
  });
  const std::vector<double> nothing(3, -std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isinf(greatest_log(before.weight.data(), nothing.data(), 3)));
}

TEST(ParticleKernels, EveryTargetSumsAlikeAndAsThePlainLoop) {
  const ParticleSet particles = some_particles();
  const Pose2 mean{1.0, -2.0, 3.0};
  PoseSums slow;
  SpreadSums slow_spread;
  double squares = 0.0;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const double w = particles.weight[i];
    const Pose2 p = particles.pose(i);
    slow.weight += w;
    slow.x += w * p.x;
    slow.cosine += w * std::cos(p.theta);
    slow.sine += w * std::sin(p.theta);
    const double t = angle_difference(p.theta, mean.theta);
    slow_spread.xy += w * (p.x - mean.x) * (p.y - mean.y);
    slow_spread.xt += w * (p.x - mean.x) * t;
    slow_spread.tt += w * t * t;
    squares += w * w;
  }
  std::vector<double> bits;
  for_every_target([&] {
    const PoseSums sums = sum_poses(view(particles));
    EXPECT_NEAR(sums.weight, slow.weight, 1e-14 * slow.weight);
    EXPECT_NEAR(sums.x, slow.x, 1e-12 * slow.weight);
    EXPECT_NEAR(sums.cosine, slow.cosine, 1e-14 * slow.weight);
    EXPECT_NEAR(sums.sine, slow.sine, 1e-14 * slow.weight);
    const SpreadSums spread = sum_spread(view(particles), mean);
    EXPECT_NEAR(spread.xy, slow_spread.xy, 1e-11 * slow.weight);
    EXPECT_NEAR(spread.xt, slow_spread.xt, 1e-11 * slow.weight);
    EXPECT_NEAR(spread.tt, slow_spread.tt, 1e-12 * slow.weight);
    EXPECT_EQ(sum_of(particles.weight.data(), particles.size()), sums.weight);
    EXPECT_NEAR(sum_of_squares(particles.weight.data(), particles.size()), squares,
                1e-14 * squares);
    const std::vector<double> now{sums.weight, sums.x,    sums.y,    sums.cosine,
                                  sums.sine,   spread.xx, spread.xy, spread.yy,
                                  spread.xt,   spread.yt, spread.tt};
    if (bits.empty()) bits = now;
    EXPECT_EQ(now, bits);
  });
}

TEST(ParticleKernels, CellPosesAreThePosesScaledAndShifted) {
  const ParticleSet particles = some_particles();
  std::vector<std::vector<float>> first;
  for_every_target([&] {
    std::vector<std::vector<float>> out(4, std::vector<float>(particles.size()));
    to_cells(view(particles), 20.0, 3.0, -5.0,
             {out[0].data(), out[1].data(), out[2].data(), out[3].data()});
    for (std::size_t i = 0; i < particles.size(); ++i) {
      EXPECT_EQ(out[0][i], static_cast<float>(particles.x_m[i] * 20.0 + 3.0));
      EXPECT_EQ(out[1][i], static_cast<float>(particles.y_m[i] * 20.0 - 5.0));
      EXPECT_NEAR(out[2][i], std::cos(particles.theta_rad[i]), 1e-7);
      EXPECT_NEAR(out[3][i], std::sin(particles.theta_rad[i]), 1e-7);
    }
    if (first.empty()) first = out;
    EXPECT_EQ(out, first);
  });
}

}  // namespace
}  // namespace strata::localization
