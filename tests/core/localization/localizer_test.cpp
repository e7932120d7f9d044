// SPDX-License-Identifier: Apache-2.0
#include "core/localization/localizer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/localization/likelihood_field_model.hpp"
#include "core/localization/range_provider_model.hpp"
#include "tests/core/localization/box_world.hpp"

namespace strata::localization {
namespace {

using test::BoxWorld;
using test::Drive;

/// A room of 8 m x 5 m without symmetry.
BoxWorld asymmetric_room() {
  return {{0.0, 0.0, 8.0, 0.2}, {0.0, 4.8, 8.0, 5.0}, {0.0, 0.0, 0.2, 5.0}, {7.8, 0.0, 8.0, 5.0},
          {2.5, 0.0, 2.7, 2.0}, {5.0, 3.6, 6.6, 5.0}, {6.8, 0.0, 8.0, 0.8}};
}
ReflectionGrid room_map() { return test::rasterize(asymmetric_room(), 0.05, {{0, 0}, {160, 100}}); }

Pose2Gaussian near(const Pose2& pose) {
  return {pose, Eigen::Vector3d(0.04, 0.04, 0.01).asDiagonal()};
}

/// Circles in the right half of the room.
Pose2 next_motion() { return {0.12, 0.0, 0.12}; }

double track(const std::shared_ptr<const SensorModel>& model, int scans) {
  const BoxWorld world = asymmetric_room();
  Drive drive({4.0, 1.2, 0.0}, 31);
  Localizer localizer({}, model, 1);
  localizer.initialize(near(drive.truth()));
  double sum = 0.0;
  for (int n = 0; n < scans; ++n) {
    drive.step(next_motion());
    const LocalizationResult result = localizer.update(drive.look(world));
    EXPECT_TRUE(result.pose.covariance.allFinite());
    if (n >= 20) sum += weighted_error(localizer.particles(), drive.truth());
  }
  return sum / (scans - 20);
}

TEST(Localizer, TracksWithTheLikelihoodField) {
  EXPECT_LT(track(std::make_shared<LikelihoodFieldModel>(room_map()), 120), 0.06);
}

TEST(Localizer, TracksWithTheBeamModel) {
  EXPECT_LT(track(make_grid_beam_model(room_map()), 120), 0.06);
}

// As on a robot whose odometry is first heard when it drives already.
TEST(Localizer, OdometryThatComesLateMovesNothing) {
  const BoxWorld world = asymmetric_room();
  for (const int blind : {5, 13, 28}) {
    SCOPED_TRACE(blind);
    Drive drive({4.0, 1.2, 0.0}, 31);
    Localizer localizer({}, make_grid_beam_model(room_map()), 1);
    localizer.initialize(near(drive.truth()));
    Pose2 before = drive.truth();
    double error_when_it_came = 0.0;
    for (int n = 0; n < 120; ++n) {
      drive.step({0.02, 0.0, 0.02});
      Observation seen = drive.look(world);
      seen.has_odometry = n >= blind;
      seen.odom_from_robot =
          seen.has_odometry ? Pose2{30.0, -20.0, 2.0} * seen.odom_from_robot : Pose2{};
      const Pose2 now = localizer.update(seen).pose.mean;
      if (n == blind) {
        EXPECT_LT(translation_distance(before, now), 0.1);
        error_when_it_came = weighted_error(localizer.particles(), drive.truth());
      }
      before = now;
    }
    EXPECT_LT(weighted_error(localizer.particles(), drive.truth()), 0.5 * error_when_it_came);
    EXPECT_EQ(localizer.odometry_jumps(), 0U);
  }
}

TEST(Localizer, IsBitIdenticalAtOneTwoAndEightThreads) {
  const BoxWorld world = asymmetric_room();
  const auto model = make_grid_beam_model(room_map());
  std::vector<ParticleSet> sets;
  for (const int threads : {1, 2, 8}) {
    Drive drive({4.0, 1.2, 0.0}, 31);
    Localizer localizer({}, model, 1, threads);
    localizer.initialize(near(drive.truth()));
    for (int n = 0; n < 30; ++n) {
      drive.step(next_motion());
      localizer.update(drive.look(world));
    }
    sets.push_back(localizer.particles());
  }
  for (std::size_t t = 1; t < sets.size(); ++t) {
    EXPECT_EQ(sets[t].x_m, sets[0].x_m);
    EXPECT_EQ(sets[t].theta_rad, sets[0].theta_rad);
    EXPECT_EQ(sets[t].weight, sets[0].weight);
  }
}

TEST(Localizer, ScansWithoutInformationMoveTheParticlesAndAreCounted) {
  const auto model = std::make_shared<LikelihoodFieldModel>(room_map());
  Localizer localizer({}, model, 1);
  localizer.initialize(near({4.0, 1.2, 0.0}));
  Observation observation;
  observation.scan.ranges_m.assign(90, std::numeric_limits<float>::quiet_NaN());
  localizer.update(observation);
  observation.odom_from_robot = {1.0, 0.0, 0.0};
  observation.scan.ranges_m.clear();
  const LocalizationResult result = localizer.update(observation);
  EXPECT_FALSE(result.weighed);
  EXPECT_EQ(localizer.unusable_scans(), 2U);
  EXPECT_NEAR(result.pose.mean.x, 5.0, 0.1);
}

TEST(Localizer, StandingStillGatesScansButGivesEachAPose) {
  const BoxWorld world = asymmetric_room();
  Drive drive({4.0, 1.2, 0.0}, 31);
  Localizer localizer({}, std::make_shared<LikelihoodFieldModel>(room_map()), 1);
  localizer.initialize(near(drive.truth()));
  int weighed = 0;
  for (int n = 0; n < 31; ++n) weighed += localizer.update(drive.look(world)).weighed ? 1 : 0;
  EXPECT_EQ(weighed, 4);  // the first, then every tenth
}

TEST(Localizer, WeighsTheNextScanOfARobotThatStandsStillWhenItIsAsked) {
  const BoxWorld world = asymmetric_room();
  Drive drive({4.0, 1.2, 0.0}, 31);
  LocalizerConfig config;
  config.gating.every_scans = 1000;
  Localizer localizer(config, std::make_shared<LikelihoodFieldModel>(room_map()), 1);
  localizer.initialize(near(drive.truth()));
  EXPECT_TRUE(localizer.update(drive.look(world)).weighed) << "the first";
  EXPECT_FALSE(localizer.update(drive.look(world)).weighed);
  localizer.weigh_next();
  Observation blind = drive.look(world);
  std::fill(blind.scan.ranges_m.begin(), blind.scan.ranges_m.end(),
            std::numeric_limits<float>::quiet_NaN());
  EXPECT_FALSE(localizer.update(blind).weighed) << "says nothing";
  EXPECT_TRUE(localizer.update(drive.look(world)).weighed);
  EXPECT_FALSE(localizer.update(drive.look(world)).weighed) << "once";
}

TEST(Localizer, FindsItselfFromNowhere) {
  const BoxWorld world = asymmetric_room();
  const ReflectionGrid map = room_map();
  const auto model = std::make_shared<LikelihoodFieldModel>(map);
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Drive drive({4.0, 1.2, 0.0}, 40 + seed);
    Localizer localizer({}, model, seed);
    localizer.initialize_global(map);
    EXPECT_GT(localizer.particles().size(), 12000U);
    for (int n = 0; n < 50; ++n) {
      drive.step(next_motion());
      localizer.update(drive.look(world));
    }
    EXPECT_LT(weighted_error(localizer.particles(), drive.truth()), 0.15) << "seed " << seed;
    EXPECT_LT(localizer.particles().size(), 3000U);
  }
}

TEST(Localizer, RecoversFromKidnapping) {
  const BoxWorld world = asymmetric_room();
  const ReflectionGrid map = room_map();
  const auto model = std::make_shared<LikelihoodFieldModel>(map);
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Drive drive({4.0, 1.2, 0.0}, 50 + seed);
    LocalizerConfig config;
    config.recovery = kidnapping_recovery();
    Localizer localizer(config, model, seed);
    localizer.set_free_space(map);
    localizer.initialize(near(drive.truth()));
    bool was_lost = false;
    for (int n = 0; n < 60 + 75; ++n) {  // 75 scans are 15 s
      if (n == 60) drive.kidnap({1.3, 3.2, -1.0});
      drive.step(n < 60 ? next_motion() : Pose2{0.02, 0.0, 0.15});
      const LocalizationResult result = localizer.update(drive.look(world));
      if (n < 60) {
        EXPECT_NE(result.health.state, HealthState::kLost);
      }
      was_lost |= result.health.state == HealthState::kLost;
    }
    EXPECT_TRUE(was_lost);
    EXPECT_LT(weighted_error(localizer.particles(), drive.truth()), 0.3) << "seed " << seed;
  }
}

/// Whose every scan says that the robot is here, and that such a share of it are inliers of the
/// map.
class SureModel final : public SensorModel {
 public:
  double inlier = 0.95;

  std::size_t log_likelihoods(const Scan& /*scan*/, const Weighing& weighing,
                              ParticleSet& particles, std::span<double> log_likelihood,
                              WorkerPool& /*pool*/) const override {
    for (std::size_t i = 0; i < particles.size(); ++i) {
      const Pose2 off = between({4.0, 1.2, 0.0}, particles.pose(i));
      const double squared = off.x * off.x + off.y * off.y + off.theta * off.theta;
      log_likelihood[i] = -squared / (0.01 * weighing.tempering);
    }
    return 1;
  }
  [[nodiscard]] double tempering() const override { return 1.0; }
  [[nodiscard]] InlierShares inlier_shares(const Scan& /*scan*/, const Pose2& /*map_from_robot*/,
                                           const ParticleSet& /*particles*/) const override {
    return {inlier, 1.0};
  }
};

TEST(Localizer, SearchesAgainSoonAfterItHasFoundAWrongPlace) {
  const ReflectionGrid map = room_map();
  const auto model = std::make_shared<SureModel>();
  LocalizerConfig config;
  config.global_search.is_used = false;
  config.gating.every_scans = 1;
  config.recovery = kidnapping_recovery();
  Localizer localizer(config, model, 1);
  localizer.set_free_space(map);
  Drive drive({4.0, 1.2, 0.0}, 53);
  localizer.initialize(near(drive.truth()));
  std::vector<int> searches;
  std::size_t before = localizer.particles().size();
  for (int n = 0; n < 100; ++n) {
    if (n == 20) model->inlier = 0.1;
    const std::size_t particles = localizer.update(drive.look(asymmetric_room())).particles;
    if (particles > before + 5000) searches.push_back(n);
    before = particles;
  }
  ASSERT_GE(searches.size(), 2U);
  EXPECT_LT(searches[1] - searches[0], config.global_start.annealing_updates)
      << "as long as the whole search";
}

TEST(Localizer, RefusesToBeWithoutAModel) {
  EXPECT_THROW(Localizer({}, nullptr, 1), std::invalid_argument);
  Localizer localizer({}, std::make_shared<SureModel>(), 1);
  EXPECT_THROW(localizer.set_model(nullptr), std::invalid_argument);
  localizer.initialize(near({4.0, 1.2, 0.0}));
  EXPECT_THROW(localizer.set_model(nullptr), std::invalid_argument);
  Drive drive({4.0, 1.2, 0.0}, 53);
  EXPECT_TRUE(localizer.update(drive.look(asymmetric_room())).weighed) << "by the one it had";
}

TEST(Localizer, RefusesAStartThatIsNotFiniteAndGoesOnAsBefore) {
  for (const double broken :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
        -std::numeric_limits<double>::infinity()}) {
    SCOPED_TRACE(broken);
    Localizer localizer({}, std::make_shared<SureModel>(), 1);
    const Pose2Gaussian start = near({4.0, 1.2, 0.0});
    localizer.initialize(start);
    const ParticleSet before = localizer.particles();
    for (const Pose2& pose :
         {Pose2{broken, 1.2, 0.0}, Pose2{4.0, broken, 0.0}, Pose2{4.0, 1.2, broken}}) {
      EXPECT_THROW(localizer.initialize(near(pose)), InputError);
    }
    for (int k = 0; k < 9; ++k) {
      Pose2Gaussian spread = start;
      spread.covariance(k) = broken;
      EXPECT_THROW(localizer.initialize(spread), InputError) << k;
    }
    EXPECT_EQ(localizer.particles().x_m, before.x_m);
    EXPECT_EQ(localizer.particles().theta_rad, before.theta_rad);
  }
}

TEST(Localizer, RefusesAGlobalStartWithoutAFreeCell) {
  Localizer localizer({}, std::make_shared<SureModel>(), 1);
  EXPECT_THROW(localizer.initialize_global(), InputError);
  EXPECT_THROW(localizer.initialize_global(ReflectionGrid()), InputError);
  EXPECT_THROW(
      localizer.initialize_global(ReflectionGrid(0.05, {{0, 0}, {20, 20}}, kUnknownReflection)),
      InputError);
}

}  // namespace
}  // namespace strata::localization
