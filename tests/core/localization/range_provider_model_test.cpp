// SPDX-License-Identifier: Apache-2.0
#include "core/localization/range_provider_model.hpp"

#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "core/random/stream.hpp"
#include "core/rays/ray_caster.hpp"
#include "tests/support/every_target.hpp"

namespace strata::localization {
namespace {

/// Tells ranges one by one.
class SlowCaster {
 public:
  explicit SlowCaster(const ReflectionGrid& map) : caster_(map, 3.0) {}
  [[nodiscard]] double expected_range_m(const Pose2& map_from_laser, double bearing_rad) const {
    return caster_.expected_range_m(map_from_laser, bearing_rad);
  }
  [[nodiscard]] bool knows(const Eigen::Vector2d& point_m) const { return caster_.knows(point_m); }

 private:
  rays::RayCaster caster_;
};

TEST(GridBeamModel, WeighsAsAProviderOfSingleRangesDoesWithTheSameBitsOnEveryTarget) {
  RandomStream random(20, StreamId::kTest);
  ReflectionGrid map(0.05, {{-60, -50}, {80, 70}}, 0.1F);
  for (float& m : map.values()) m = random.bernoulli(0.01) ? 0.9F : 0.1F;
  Scan scan;
  scan.angle_min_rad = -2.0;
  scan.angle_increment_rad = 0.1;
  scan.range_max_m = 4.0F;
  scan.robot_from_laser = {0.1, 0.05, 0.2};
  for (int k = 0; k < 41; ++k)
    scan.ranges_m.push_back(static_cast<float>(random.uniform(0.1, 4.5)));
  ParticleSet particles;
  particles.resize(333);
  for (std::size_t i = 0; i < particles.size(); ++i) {
    particles.set_pose(
        i, {random.uniform(-4.0, 5.0), random.uniform(-3.5, 4.5), random.uniform(-3.0, 3.0)});
  }
  const auto weigh = [&](const SensorModel& model, int threads) {
    std::vector<double> log_likelihood(particles.size());
    WorkerPool pool(threads);
    EXPECT_EQ(model.log_likelihoods(scan, {2.0}, particles, log_likelihood, pool), 41U);
    return log_likelihood;
  };
  const RangeProviderModel<rays::RayCaster> model(
      std::make_shared<const rays::RayCaster>(map, 3.0));
  const std::vector<double> got = weigh(model, 1);
  const std::vector<double> slow =
      weigh(RangeProviderModel<SlowCaster>(std::make_shared<const SlowCaster>(map)), 1);
  for (std::size_t i = 0; i < got.size(); ++i) EXPECT_NEAR(got[i], slow[i], 1e-6);
  for (const int threads : {2, 8}) EXPECT_EQ(weigh(model, threads), got);
  test::for_every_target([&] { EXPECT_EQ(weigh(model, 1), got); });
}

}  // namespace
}  // namespace strata::localization
