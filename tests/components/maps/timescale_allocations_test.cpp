// SPDX-License-Identifier: Apache-2.0
// Has a program of its own, whose allocations it counts.
#include <memory>

#include <gtest/gtest.h>

#include "components/maps/map_model.hpp"
#include "core/localization/localizer.hpp"
#include "tests/components/maps/learned_room.hpp"
#include "tests/support/counted_allocations.hpp"

namespace strata::maps {
namespace {

using test::allocations;

/// The robot turns and drives in the room, 20 scans a second.
std::vector<Observation> drive(int scans) {
  std::vector<Observation> observations;
  for (int i = 0; i < scans; ++i) {
    const Pose2 pose{-1.0 + 0.5 * std::sin(0.02 * i), 0.2, 0.02 * i};
    Observation observation;
    observation.scan = memory::test_world::observe(pose, 9000.0 + 0.05 * i, i % 2 == 0).scan;
    observation.odom_from_robot = pose;
    observation.has_odometry = true;
    observations.push_back(std::move(observation));
  }
  return observations;
}

std::size_t allocations_of(const std::string& name) {
  const Maps maps = test_room::make_maps();
  const MapModel model = make_map_model(maps, name, {});
  const std::vector<Observation> observations = drive(200);
  localization::LocalizerConfig config;
  config.particles = 200;
  localization::Localizer localizer(config, model.sensor, 1);
  localizer.initialize(
      {observations[0].odom_from_robot, Eigen::Vector3d(1e-3, 1e-3, 1e-3).asDiagonal()});
  for (std::size_t i = 0; i < 100; ++i) localizer.update(observations[i]);
  const std::size_t before = allocations;
  for (std::size_t i = 100; i < 200; ++i) localizer.update(observations[i]);
  return allocations - before;
}

/// Of the later half of 60 scans of a robot that stands.
std::size_t allocations_of_standing(const std::string& name) {
  const Maps maps = test_room::make_maps();
  const MapModel model = make_map_model(maps, name, {});
  std::vector<Observation> standing = drive(1);
  localization::LocalizerConfig config;
  config.particles = 200;
  config.gating.every_scans = 1;
  localization::Localizer localizer(config, model.sensor, 1);
  localizer.initialize(
      {standing[0].odom_from_robot, Eigen::Vector3d(1e-3, 1e-3, 1e-3).asDiagonal()});
  std::size_t before = 0;
  for (int i = 0; i < 60; ++i) {  // all of it within the node's second
    if (i == 30) before = allocations;
    standing[0].scan.stamp.ns += 10'000'000;
    EXPECT_TRUE(localizer.update(standing[0]).weighed);
  }
  return allocations - before;
}

TEST(TimescaleModel, AllocatesNothingPerScan) { EXPECT_EQ(allocations_of("timescale_frozen"), 0U); }

TEST(TimescaleModel, ThatLearnsAllocatesForTheScansThatItTakesOnly) {
  // A node takes a scan at most once a second or 10 degrees; each makes a new snapshot.
  const std::size_t learning = allocations_of("timescale");
  EXPECT_GT(learning, 0U);
  EXPECT_EQ(allocations_of_standing("timescale"), 0U);
}

TEST(CellModel, AllocatesNothingWhileItShowsTheSame) {
  EXPECT_EQ(allocations_of_standing("cells"), 0U);
}

}  // namespace
}  // namespace strata::maps
