// SPDX-License-Identifier: Apache-2.0
#include "tools/simulate/space.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tools/simulate/simulation.hpp"

namespace strata::simulate {
namespace {

/// A wall at x = 4, a table from (1, 1) to (2, 2) of 0.8 m, a person at (0, 3).
Space example() {
  ScenarioConfig scenario;
  scenario.blocks.push_back({{1.0, 1.0, 2.0, 2.0}, 0.8});
  const std::vector<Segment> still{{{4.0, -5.0}, {4.0, 5.0}},
                                   {{1.0, 1.0}, {2.0, 1.0}},
                                   {{2.0, 1.0}, {2.0, 2.0}},
                                   {{2.0, 2.0}, {1.0, 2.0}},
                                   {{1.0, 2.0}, {1.0, 1.0}}};
  const std::vector<Circle> legs{{{-0.12, 3.0}, 0.07}, {{0.12, 3.0}, 0.07}};
  return make_space(scenario, still, 1, {}, legs);
}

Eigen::Vector3d towards(double x, double y, double z) {
  return Eigen::Vector3d(x, y, z).normalized();
}

TEST(Space, EndsRaysOnWallsFloorAndCeiling) {
  const Space space = example();
  const Eigen::Vector3d from(0.0, 0.0, 1.0);
  EXPECT_NEAR(first_hit(space, from, towards(1, 0, 0)).range_m, 4.0, 1e-12);
  EXPECT_NEAR(first_hit(space, from, towards(4, 0, 1)).range_m, std::sqrt(17.0), 1e-12);
  EXPECT_NEAR(first_hit(space, from, towards(0, 0, -1)).range_m, 1.0, 1e-12);
  EXPECT_NEAR(first_hit(space, from, towards(0, 0, 1)).range_m, 1.6, 1e-12);
  EXPECT_NEAR(first_hit(space, from, towards(-1, 0, -1)).range_m, std::sqrt(2.0), 1e-12);
}

TEST(Space, SeesTheTopOfATableFromAboveAndPassesOverIt) {
  const Space space = example();
  const SpaceHit top = first_hit(space, {1.5, 1.5, 2.0}, towards(0, 0, -1));
  EXPECT_NEAR(top.range_m, 1.2, 1e-12);
  EXPECT_NEAR(first_hit(space, {0.0, 1.5, 0.5}, towards(1, 0, 0)).range_m, 1.0, 1e-12);
  EXPECT_NEAR(first_hit(space, {0.0, 1.5, 1.0}, towards(1, 0, 0)).range_m, 4.0, 1e-12);
  EXPECT_NEAR(first_hit(space, {0.5, 1.5, 2.0}, towards(0, 0, -1)).range_m, 2.0, 1e-12);
}

TEST(Space, HasPeopleWithLegsAndABody) {
  const Space space = example();
  const SpaceHit body = first_hit(space, {0.0, 0.0, 1.2}, towards(0, 1, 0));
  EXPECT_EQ(body.source, BeamSource::kPerson);
  EXPECT_NEAR(body.range_m, 2.8, 1e-12);
  // Between the legs, and over the head.
  EXPECT_NE(first_hit(space, {0.0, 0.0, 0.3}, towards(0, 1, 0)).source, BeamSource::kPerson);
  EXPECT_NE(first_hit(space, {0.0, 0.0, 1.8}, towards(0, 1, 0)).source, BeamSource::kPerson);
  EXPECT_NEAR(first_hit(space, {0.12, 0.0, 0.3}, towards(0, 1, 0)).range_m, 2.93, 1e-12);
}

TEST(Space, TurnsATiltingScannersPlaneAboutItsYAxis) {
  Scanner3Config scanner;
  scanner.kind = Scanner3Kind::kTilting;
  scanner.layers = 3;
  scanner.beams = 3;
  scanner.field_of_view_deg = 270.0;
  scanner.noise_m = 0.0;
  scanner.drop_probability = 0.0;
  SimulatedCloud cloud;
  RandomStream random(1, StreamId::kTest);
  Pose3 pose;
  pose.translation.z() = 1.0;
  scan_layer(scanner, 2, example(), pose, 0.5, random, cloud);
  ASSERT_EQ(cloud.points_m.size(), 3U);
  EXPECT_EQ(cloud.offset_s[1], 0.5F);
  EXPECT_NEAR(std::atan2(cloud.points_m[1].z(), cloud.points_m[1].x()), 40.0 * M_PI / 180.0, 1e-6);
  EXPECT_NEAR(cloud.points_m[1].z(), 1.6, 1e-6);
  EXPECT_NEAR(cloud.points_m[2].z(), 0.0, 1e-6);  // along y, where tilting changes nothing
}

TEST(Space, TakesImagesThroughAPinhole) {
  CameraConfig camera;
  camera.width = 9;
  camera.height = 9;
  camera.mount_z_m = 1.2;
  const Space space = example();
  Pose3 facing_person = robot_from_camera(camera);
  facing_person.rotation = rotation_about_z(M_PI / 2) * facing_person.rotation;
  const report::Image image = take_image(camera, space, facing_person);
  EXPECT_EQ(image.at(4, 4), (report::Color{230, 0, 160}));
  EXPECT_NE(image.at(0, 4), (report::Color{230, 0, 160}));
  // Above the horizon the ceiling, below it the floor.
  EXPECT_GT(image.at(4, 0).r, 180);
  EXPECT_LT(image.at(4, 8).r, 160);
}

TEST(Space, CloudsOfAScenarioLieOnWhatTheySay) {
  ScenarioConfig scenario = load_scenario(STRATA_SCENARIO_DIR "/room_people_3d.yaml");
  scenario.scanner3.noise_m = 0.0;
  scenario.scanner3.beams = 60;
  scenario.camera.rate_hz = 0.0;
  scenario.robot.route = {1.5, 4.0, 5.0, 4.0};
  const Simulation simulation = simulate(scenario, 7);
  const SimulatedDay& day = simulation.days.front();
  ASSERT_GT(day.clouds.size(), 3U);
  std::size_t on_people = 0;
  for (const SimulatedCloud& cloud : day.clouds) {
    ASSERT_EQ(cloud.points_m.size(), 40U * 60U);
    ASSERT_EQ(cloud.sources.size(), cloud.points_m.size());
    const auto scan = std::find_if(day.scans.begin(), day.scans.end(), [&](const SimulatedScan& s) {
      return s.observation.scan.stamp == cloud.stamp;
    });
    ASSERT_NE(scan, day.scans.end());
    const Pose3 pose = lift(scan->map_from_robot) * robot_from_scanner(scenario.scanner3);
    for (std::size_t i = 0; i < cloud.points_m.size(); ++i) {
      if (cloud.sources[i] == BeamSource::kNothing) continue;
      const Eigen::Vector3d p = pose * cloud.points_m[i].cast<double>().eval();
      EXPECT_TRUE(p.x() > -1e-4 && p.x() < 14.0001 && p.y() > -1e-4 && p.y() < 8.0001);
      EXPECT_TRUE(p.z() > -1e-4 && p.z() < 2.6001);
      if (cloud.sources[i] != BeamSource::kPerson) continue;
      ++on_people;
      EXPECT_LT(p.z(), 1.7501);
    }
  }
  EXPECT_GT(on_people, 50U);
}

}  // namespace
}  // namespace strata::simulate
