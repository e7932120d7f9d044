// SPDX-License-Identifier: Apache-2.0
#include "components/maps/timescale_model.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/memory/nodes/room_world.hpp"

namespace strata::maps {
namespace {

/// What the model expects straight ahead, at the box or the wall behind it.
double ahead(const TimescaleModel& model) { return model.expected_range_m({-1.5, 0.2, 0.0}, 0.0); }

/// A memory of one node in which the box is new: the short level knows it, the long one does not.
std::shared_ptr<const memory::TimescaleMemory> with_new_box() {
  auto memory = std::make_shared<memory::TimescaleMemory>();
  for (int t = 0; t < 40; ++t) {
    memory->observe(memory::test_world::observe({-1.5, 0.2, 0.0}, t, t >= 30));
  }
  return memory;
}

std::unique_ptr<localization::SensorModel> copy_for_one_run(const TimescaleUse& use) {
  const auto memory = with_new_box();
  return TimescaleModel(memory, memory->decode(), {}, use).for_one_run();
}

TEST(TimescaleModel, LearnsInACopyOfItsOwnAndLeavesTheSharedOneAlone) {
  const auto memory = with_new_box();
  const std::vector<std::byte> before = memory->state();
  TimescaleUse use;
  use.level = 0;
  use.unsettled_s = 0.0;
  const TimescaleModel shared(memory, memory->decode(), {}, use);
  ASSERT_NEAR(ahead(shared), 3.5, 0.15);
  const auto own = shared.for_one_run();
  Observation observation;
  observation.run = 2;
  Pose2Gaussian pose{{-1.5, 0.2, 0.0}, Eigen::Matrix3d::Identity() * 1e-4};
  for (int t = 0; t < 20; ++t) {
    observation.scan = memory::test_world::observe(pose.mean, 9000.0 + t, false).scan;
    own->learn(observation, pose, {});
  }
  EXPECT_NEAR(ahead(dynamic_cast<const TimescaleModel&>(*own)), 6.5, 0.15);
  EXPECT_NEAR(ahead(shared), 3.5, 0.15);
  EXPECT_EQ(memory->state(), before);
}

TEST(TimescaleModel, LearnsNothingFromAnUncertainPose) {
  TimescaleUse use;
  use.level = 0;
  use.unsettled_s = 0.0;
  const auto own = copy_for_one_run(use);
  const auto& model = dynamic_cast<const TimescaleModel&>(*own);
  const double before = ahead(model);
  Observation observation;
  observation.run = 2;
  for (int t = 0; t < 20; ++t) {
    observation.scan = memory::test_world::observe({-1.5, 0.2, 0.0}, 9000.0 + t, false).scan;
    own->learn(observation, {{-1.5, 0.2, 0.0}, Eigen::Matrix3d::Identity()}, {});
  }
  EXPECT_EQ(ahead(model), before);
}

TEST(TimescaleModel, LearnsNothingFromAPoseOfTooLowAScoreOrInDoubt) {
  TimescaleUse use;
  use.level = 0;
  use.unsettled_s = 0.0;
  use.min_score = 0.5;
  const Pose2Gaussian pose{{-1.5, 0.2, 0.0}, Eigen::Matrix3d::Identity() * 1e-4};
  Observation observation;
  observation.run = 2;
  for (const auto& [trust, learns] : {std::pair(localization::PoseTrust{0.4, false}, false),
                                      std::pair(localization::PoseTrust{0.9, true}, false),
                                      std::pair(localization::PoseTrust{0.6, false}, true)}) {
    const auto own = copy_for_one_run(use);
    const auto& model = dynamic_cast<const TimescaleModel&>(*own);
    ASSERT_NEAR(ahead(model), 3.5, 0.15);
    for (int t = 0; t < 20; ++t) {
      observation.scan = memory::test_world::observe(pose.mean, 9000.0 + t, false).scan;
      own->learn(observation, pose, trust);
    }
    EXPECT_NEAR(ahead(model), learns ? 6.5 : 3.5, 0.15) << trust.score;
  }
}

/// Free but for a wall across.
ReflectionGrid grid_with_wall_at(double wall_x_m) {
  ReflectionGrid grid(0.05, CellRect{{-100, -100}, {160, 100}}, 0.0F);
  for (int y = -100; y < 100; ++y) {
    grid.at(grid.cell_at({wall_x_m, 0.05 * y + 0.025})) = 1.0F;
  }
  return grid;
}

// A memory that has looked only backwards: ahead it knows nothing.
TEST(TimescaleModel, CastsABeamInTheBaseMapWhereTheMemorySaysNothing) {
  auto memory = std::make_shared<memory::TimescaleMemory>();
  for (int t = 0; t < 40; ++t) {
    PosedScan behind = memory::test_world::observe({-1.5, 0.2, 0.0}, t, false);
    for (std::size_t i = 0; i < behind.scan.size(); ++i) {
      if (std::abs(behind.scan.bearing_rad(i)) < 1.5) {
        behind.scan.ranges_m[i] = std::numeric_limits<float>::quiet_NaN();
      }
    }
    memory->observe(behind);
  }
  TimescaleUse use;
  use.goes_on_learning = false;
  const auto base = std::make_shared<const rays::RayCaster>(grid_with_wall_at(4.0));
  const TimescaleModel alone(memory, memory->decode(), {}, use);
  const TimescaleModel model(memory, memory->decode(), {}, use, base);
  const Pose2 laser{-1.5, 0.2, 0.0};
  EXPECT_TRUE(std::isinf(alone.expected_range_m(laser, 0.0)));
  EXPECT_NEAR(model.expected_range_m(laser, 0.0), 5.5, 0.05);
  // Where the memory knows, at x = -4, it decides: the base map has nothing there.
  EXPECT_NEAR(model.expected_range_m(laser, std::numbers::pi), 2.5, 0.15);

  // Particles are weighed so too: with the wall where the base map has it, the place from which
  // the scan fits is the likelier one, which the memory alone cannot tell.
  Scan ahead = memory::test_world::observe(laser, 9000.0, false).scan;
  for (std::size_t i = 0; i < ahead.size(); ++i) {
    const double bearing = ahead.bearing_rad(i);
    ahead.ranges_m[i] = std::abs(bearing) < 0.5 ? static_cast<float>(5.5 / std::cos(bearing))
                                                : std::numeric_limits<float>::quiet_NaN();
  }
  WorkerPool pool(1);
  const auto advantage = [&](const TimescaleModel& of) {
    localization::ParticleSet particles;
    particles.resize(2);
    particles.set_pose(0, laser);
    particles.set_pose(1, laser * Pose2{0.4, 0.0, 0.0});
    std::vector<double> log_likelihood(2, 0.0);
    EXPECT_GT(of.log_likelihoods(ahead, {1.0}, particles, log_likelihood, pool), 0U);
    return log_likelihood[0] - log_likelihood[1];
  };
  EXPECT_LT(std::abs(advantage(alone)), 0.5);
  EXPECT_GT(advantage(model), 5.0);
  const localization::InlierShares said = model.inlier_shares(ahead, laser, {});
  EXPECT_GT(said.inlier, 0.95);
  EXPECT_EQ(alone.inlier_shares(ahead, laser, {}).judged, 0.0);
}

// What the base map has in the way, and the nodes have seen through, is passed.
TEST(TimescaleModel, SeesThroughWhatTheBaseMapHasWhereTheNodesSawFreeWay) {
  memory::TimescaleConfig config;
  config.max_range_m = 4.0;
  config.range_bins = 25;
  auto memory = std::make_shared<memory::TimescaleMemory>(config);
  for (int t = 0; t < 40; ++t) {
    memory->observe(memory::test_world::observe({-1.5, 0.2, 0.0}, t, false));
  }
  ReflectionGrid grid = grid_with_wall_at(5.0);
  grid.at(grid.cell_at({1.0, 0.2})) = 1.0F;  // 2.5 m ahead; nodes see 4 m of free way
  TimescaleUse use;
  use.goes_on_learning = false;
  localization::BeamModelConfig beam;
  beam.beams.max_range_m = 10.0;
  const TimescaleModel model(memory, memory->decode(), beam, use,
                             std::make_shared<const rays::RayCaster>(grid));
  const Pose2 laser{-1.5, 0.2, 0.0};
  Scan scan = memory::test_world::observe(laser, 9000.0, false).scan;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    if (std::abs(scan.bearing_rad(i)) > 0.005) {
      scan.ranges_m[i] = std::numeric_limits<float>::quiet_NaN();
    }
  }
  EXPECT_EQ(model.inlier_shares(scan, laser, {}).inlier, 1.0);
}

TEST(TimescaleModel, TrustsTheLevelThatExplainsTheScansEvenWhenFrozen) {
  TimescaleUse use;
  use.goes_on_learning = false;
  const auto own = copy_for_one_run(use);
  const auto& model = dynamic_cast<const TimescaleModel&>(*own);
  // By default a level that nobody believes is not asked, and only the slowest is believed.
  ASSERT_EQ(model.believed().size(), 1U);
  EXPECT_EQ(model.believed()[0].level, 2);
  EXPECT_NEAR(ahead(model), 6.5, 0.15);
  Observation observation;
  observation.run = 2;
  const Pose2Gaussian pose{{-1.5, 0.2, 0.0}, Eigen::Matrix3d::Identity() * 1e-4};
  for (int t = 0; t < 10; ++t) {
    observation.scan = memory::test_world::observe(pose.mean, 9000.0 + t, true).scan;
    own->learn(observation, pose, {});
  }
  EXPECT_NEAR(ahead(model), 3.5, 0.15);
  EXPECT_GT(model.believed()[0].weight, 0.4);
  for (int t = 0; t < 10; ++t) {
    observation.scan = memory::test_world::observe(pose.mean, 9100.0 + t, false).scan;
    own->learn(observation, pose, {});
  }
  EXPECT_EQ(model.believed()[0].level, 2);
  EXPECT_NEAR(ahead(model), 6.5, 0.15);
  use.level = 1;
  EXPECT_EQ(copy_for_one_run(use), nullptr);  // nothing to learn: may be shared
}

/// ln p, tempered by 2, of a scan that every other beam ahead sees the box in, or all of them; by
/// one level, or by all with even weights.
double log_p_of(bool is_in_turns, std::optional<int> level) {
  TimescaleUse use;
  use.level = level;
  use.goes_on_learning = false;
  use.mixture.unearned = 1.0;
  const auto memory = with_new_box();
  localization::BeamModelConfig config;
  config.beams.min_angle_rad = 0.0;
  const TimescaleModel model(memory, memory->decode(), config, use);
  const Pose2 pose{-1.5, 0.2, 0.0};
  Scan scan = memory::test_world::observe(pose, 9000.0, true, 1, 0.0).scan;
  const Scan without = memory::test_world::observe(pose, 9000.0, false, 1, 0.0).scan;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const bool is_ahead = i >= 172 && i < 188;
    if (is_ahead && is_in_turns && i % 2 == 0) scan.ranges_m[i] = without.ranges_m[i];
    if (!is_ahead) scan.ranges_m[i] = std::numeric_limits<float>::quiet_NaN();
  }
  localization::ParticleSet particles;
  particles.resize(1);
  particles.set_pose(0, pose);
  std::vector<double> log_p(1);
  WorkerPool pool(1);
  EXPECT_EQ(model.log_likelihoods(scan, {2.0}, particles, log_p, pool), 16U);
  return log_p[0];
}

// In closed form from what each level says alone.
TEST(TimescaleModel, HasOneLevelExplainAScanNotEachBeamItsOwn) {
  for (const bool is_in_turns : {false, true}) {
    double sum = 0.0;
    for (const int level : {0, 1, 2}) sum += std::exp(2.0 * log_p_of(is_in_turns, level)) / 3.0;
    EXPECT_NEAR(log_p_of(is_in_turns, std::nullopt), 0.5 * std::log(sum), 1e-9);
  }
  // Were each of 16 beams free to choose, half of them the one and half the other level would
  // explain the scan as well as one level all of the other.
  EXPECT_GT(log_p_of(false, std::nullopt) - log_p_of(true, std::nullopt), 8.0);
}

}  // namespace
}  // namespace strata::maps
