// SPDX-License-Identifier: Apache-2.0
/// The process of a robot that maps in 3-D is killed on its host, while its scanner lives on
/// another.
#include <cmath>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "strata_idl/tf2_msgs.h"
#include <Eigen/Core>
#include <gtest/gtest.h>

#include "components/convert/cdr.hpp"
#include "components/convert/cloud_messages.hpp"
#include "components/convert/geometry_messages.hpp"
#include "components/log/bag.hpp"
#include "components/log/log_writer.hpp"
#include "core/volume/volume_map.hpp"
#include "tests/network/killed_robot.hpp"
#include "tests/tools/strata/program.hpp"

namespace fs = std::filesystem;

namespace strata::test {
namespace {

constexpr double kLogSeconds = 300.0;
constexpr double kCloudsPerSecond = 10.0;

/// A post 5 m from the scanner, at another place in each cloud.
std::vector<Eigen::Vector3f> post(int cloud) {
  const double angle_rad = 0.03 * cloud;
  std::vector<Eigen::Vector3f> points;
  for (double z_m = -0.5; z_m <= 0.5; z_m += 0.1) {
    points.emplace_back(5.0 * std::cos(angle_rad), 5.0 * std::sin(angle_rad), z_m);
  }
  return points;
}

void write_log(const fs::path& folder) {
  log::BagWriter bag(folder, log::BagOptions{});
  const std::size_t tf =
      bag.add_topic({"/tf_static", "tf2_msgs/msg/TFMessage", "cdr", log::recorded_qos(true)});
  tf2_msgs::msg::TFMessage transforms;
  transforms.transforms().push_back(
      convert::to_transform_stamped(Stamp(), Pose2{}, "map", "scanner"));
  bag.write(tf, Stamp{1}, convert::to_cdr(transforms));
  const std::size_t points =
      bag.add_topic({"/points", "sensor_msgs/msg/PointCloud2", "cdr", log::recorded_qos()});
  for (int cloud = 0; cloud < kLogSeconds * kCloudsPerSecond; ++cloud) {
    const Stamp stamp = Stamp::from_seconds(1.0 + cloud / kCloudsPerSecond);
    bag.write(points, stamp, convert::to_cdr(convert::to_message(post(cloud), stamp, "scanner")));
  }
}

volume::VolumeMap map_in(const fs::path& store) {
  return volume::VolumeMap::from_file(bytes_of(store), store.string());
}

std::size_t occupied_in(const fs::path& store) {
  if (!fs::exists(store)) return 0;
  std::size_t voxels = 0;
  volume::for_each_voxel(map_in(store), [&](const volume::VoxelKey&) { ++voxels; });
  return voxels;
}

/// Of the leaves of `before`, those of which `after` knows nothing.
std::size_t forgotten(const volume::VolumeMap& before, const volume::VolumeMap& after) {
  std::size_t count = 0;
  before.for_each_cube([&](const volume::VoxelCube& cube) {
    if (!after.log_odds(before.lattice().center_m(cube.corner))) ++count;
  });
  return count;
}

class RobotThatMapsIn3d : public KilledRobot {
 protected:
  void SetUp() override {
    KilledRobot::SetUp();
    if (IsSkipped()) return;
    write_log(at("log"));
    std::ofstream(at("sensors.yaml"))
        << "version: 1\nprocesses:\n  - name: sensors\n    components:\n"
           "      - {type: strata::Player, name: player, parameters: {mode: messages, log: "
        << at("log").string() << "}}\n";
    std::ofstream(at("robot.yaml"))
        << "version: 1\nprocesses:\n  - name: robot\n    restart: on_failure\n"
           "    restart_delay_s: 0\n    components:\n"
           "      - type: strata::VolumeMapper\n        name: mapper\n        parameters: "
           "{store_period_s: 0.2, store: "
        << store().string() << "}\n";
  }
  [[nodiscard]] fs::path store() const { return at("map.ot"); }
};

TEST_F(RobotThatMapsIn3d, GoesOnWithItsOctreeWhenItsProcessIsKilled) {
  if (IsSkipped()) return;
  const auto sensors = run(1, "sensors.yaml");
  const auto robot = run(0, "robot.yaml");
  for (int life = 1; life <= 2; ++life) {
    const std::size_t known = occupied_in(store());
    ASSERT_TRUE(comes_true([&] { return occupied_in(store()) > known + 20; })) << "life " << life;
    const volume::VolumeMap before = map_in(store());
    kill_and_wait(*robot);
    const std::string at_the_kill = bytes_of(store());
    ASSERT_TRUE(comes_true([&] { return bytes_of(store()) != at_the_kill; })) << "life " << life;
    EXPECT_EQ(forgotten(before, map_in(store())), 0U) << "life " << life;
  }
}

}  // namespace
}  // namespace strata::test
