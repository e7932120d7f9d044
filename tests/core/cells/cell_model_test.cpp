// SPDX-License-Identifier: Apache-2.0
#include "core/cells/cell_model.hpp"

#include <limits>
#include <memory>

#include <gtest/gtest.h>

#include "tests/core/cells/corridor.hpp"

namespace strata::cells {
namespace {

using namespace test_corridor;

std::shared_ptr<const CellMap> make_map() {
  CellLearner learner(kResolution_m);
  for (int i = 0; i < 5; ++i) visit(learner, 3600.0 * i, false);
  return std::make_shared<const CellMap>(learned(learner));
}

/// What an own copy expects along x after a minute before the closed door.
double expected_after(const localization::PoseTrust& trust, const CellModel& model) {
  const auto own = model.for_one_run();
  auto* cells = dynamic_cast<CellModel*>(own.get());
  for (int i = 0; i < 120; ++i) {
    Observation observation;
    observation.scan = look(20000.0 + 0.5 * i, true).scan;
    cells->learn(observation, {kPose, Eigen::Matrix3d::Zero()}, trust);
  }
  return cells->ranges()->expected_range_m(kPose, 0.0);
}

TEST(CellModel, FollowsScansInItsOwnCopyOnly) {
  const CellModel model(make_map(), {});
  EXPECT_NEAR(model.ranges()->expected_range_m(kPose, 0.0), kWall_m - kPose.x, 0.02);
  EXPECT_NEAR(expected_after({1.0, false}, model), kDoor_m - kPose.x, 0.02);
  EXPECT_NEAR(model.ranges()->expected_range_m(kPose, 0.0), kWall_m - kPose.x, 0.02);
}

TEST(CellModel, LearnsNothingFromPosesInDoubt) {
  const CellModel model(make_map(), {});
  EXPECT_NEAR(expected_after({1.0, true}, model), kWall_m - kPose.x, 0.02);
  EXPECT_NEAR(expected_after({0.1, false}, model), kWall_m - kPose.x, 0.02);
}

TEST(CellModel, OfNoCellsExpectsNothing) {
  const CellModel model(std::make_shared<const CellMap>(), {});
  EXPECT_EQ(model.ranges()->expected_range_m(kPose, 0.0), std::numeric_limits<double>::infinity());
  EXPECT_EQ(expected_after({1.0, false}, model), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace strata::cells
