// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/localization/likelihood_field_kernel.hpp"
#include "core/localization/likelihood_field_model.hpp"
#include "core/random/stream.hpp"
#include "core/scan/endpoints.hpp"
#include "tests/support/every_target.hpp"

namespace strata::localization {
namespace {

TEST(FieldKernel, EverySimdTargetGivesTheNumbersOfTheScalarReference) {
  RandomStream random(11, StreamId::kTest);
  std::vector<std::uint16_t> values(70 * 50);
  for (std::uint16_t& v : values) v = static_cast<std::uint16_t>(random.below(65536));
  const FieldTable table{70, 50, values.data()};
  // More points than one block of the kernel, a block and less than a vector, and fewer than any.
  for (const std::size_t beams : {1300, 517, 181, 16, 3}) {
    const std::size_t count = 21;
    std::vector<float> x(count), y(count), c(count), s(count);
    std::vector<std::uint32_t> expected(count), got(count);
    for (std::size_t i = 0; i < count; ++i) {
      const double angle = random.uniform(-4.0, 4.0);
      x[i] = static_cast<float>(random.uniform(-20.0, 90.0));
      y[i] = static_cast<float>(random.uniform(-20.0, 70.0));
      c[i] = static_cast<float>(std::cos(angle));
      s[i] = static_cast<float>(std::sin(angle));
    }
    std::vector<float> px(beams), py(beams);
    for (std::size_t k = 0; k < px.size(); ++k) {
      px[k] = static_cast<float>(random.uniform(-60.0, 60.0));
      py[k] = static_cast<float>(random.uniform(-60.0, 60.0));
    }
    const FieldPoses poses{x.data(), y.data(), c.data(), s.data(), count};
    const FieldPoints points{px.data(), py.data(), px.size()};
    sum_field_scalar(table, poses, points, expected.data());
    test::for_every_target([&] {
      sum_field(table, poses, points, got.data());
      EXPECT_EQ(got, expected);
    });
  }
}

TEST(LikelihoodFieldModel, EqualsTheSumOverEndPoints) {
  ReflectionGrid map(0.05, {{-40, -40}, {60, 60}}, 0.0F);
  for (int i = -40; i < 60; ++i) map.at({i, 20}) = map.at({i / 2, -10}) = 1.0F;
  const LikelihoodFieldModelConfig config;
  const LikelihoodFieldModel model(map, config);
  const LikelihoodField field(map, config.field);
  Scan scan;
  scan.angle_min_rad = -1.5F;
  scan.angle_increment_rad = 0.0301F;
  scan.range_max_m = 5.0F;
  scan.robot_from_laser = {0.2, 0.0, 0.1};
  RandomStream random(2, StreamId::kTest);
  for (int i = 0; i < 100; ++i)
    scan.ranges_m.push_back(static_cast<float>(random.uniform(0.3, 4.0)));
  ParticleSet particles;
  particles.resize(40);
  for (std::size_t i = 0; i < 40; ++i) {
    particles.set_pose(
        i, {random.uniform(-1.0, 2.0), random.uniform(-1.0, 2.0), random.uniform(-3.0, 3.0)});
  }
  std::vector<double> got(40);
  WorkerPool pool(2);
  EXPECT_EQ(model.log_likelihoods(scan, {2.0}, particles, got, pool), 100U);
  const Endpoints points = endpoints_in_robot(scan);
  for (std::size_t i = 0; i < 40; ++i) {
    double sum = 0.0;
    for (std::size_t k = 0; k < points.size(); ++k) {
      sum += field.at(particles.pose(i) * Eigen::Vector2d(points.x_m[k], points.y_m[k]));
    }
    // A point within float rounding of a cell border may fall on its other side.
    EXPECT_NEAR(got[i], sum / 2.0, 0.3);
  }
}

}  // namespace
}  // namespace strata::localization
