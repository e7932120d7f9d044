// SPDX-License-Identifier: Apache-2.0
#include "components/maps/timescale_model.hpp"

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
    own->learn(observation, pose);
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
    own->learn(observation, {{-1.5, 0.2, 0.0}, Eigen::Matrix3d::Identity()});
  }
  EXPECT_EQ(ahead(model), before);
}

TEST(TimescaleModel, TrustsTheLevelThatExplainsTheScansEvenWhenFrozen) {
  TimescaleUse use;
  use.goes_on_learning = false;
  use.min_weight = 0.0;
  const auto own = copy_for_one_run(use);
  const auto& model = dynamic_cast<const TimescaleModel&>(*own);
  ASSERT_EQ(model.believed().size(), 3U);
  Observation observation;
  observation.run = 2;
  const Pose2Gaussian pose{{-1.5, 0.2, 0.0}, Eigen::Matrix3d::Identity() * 1e-4};
  for (int t = 0; t < 10; ++t) {
    observation.scan = memory::test_world::observe(pose.mean, 9000.0 + t, true).scan;
    own->learn(observation, pose);
  }
  EXPECT_NEAR(ahead(model), 3.5, 0.15);
  EXPECT_EQ(model.believed()[0].level, 0);
  EXPECT_GT(model.believed()[0].weight, 0.4);
  double total = 0.0;
  for (const auto& believed : model.believed()) total += believed.weight;
  EXPECT_NEAR(total, 1.0, 1e-9);
  // By default a level that nobody believes is not asked.
  use.min_weight = TimescaleUse{}.min_weight;
  const auto usual = copy_for_one_run(use);
  for (int t = 0; t < 200; ++t) {
    observation.scan = memory::test_world::observe(pose.mean, 9000.0 + t, true).scan;
    usual->learn(observation, pose);
  }
  EXPECT_LT(dynamic_cast<const TimescaleModel&>(*usual).believed().size(), 3U);
  EXPECT_NEAR(ahead(dynamic_cast<const TimescaleModel&>(*usual)), 3.5, 0.15);
  use.level = 1;
  EXPECT_EQ(copy_for_one_run(use), nullptr);  // nothing to learn: may be shared
}

}  // namespace
}  // namespace strata::maps
