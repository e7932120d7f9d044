// SPDX-License-Identifier: Apache-2.0
/// What strata::VolumeMapper writes at the end of a replay.
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "strata_idl/tf2_msgs.h"
#include <gtest/gtest.h>
#include <octomap/ColorOcTree.h>

#include "components/convert/cdr.hpp"
#include "components/convert/cloud_messages.hpp"
#include "components/convert/geometry_messages.hpp"
#include "components/convert/scan_messages.hpp"
#include "components/log/bag.hpp"
#include "core/volume/volume_map.hpp"
#include "tests/support/test_data.hpp"
#include "tests/tools/strata/program.hpp"

namespace fs = std::filesystem;

namespace strata::tools {
namespace {

using test::quoted;
using test::run_strata;

/// A wall at x = 2 m for nine seconds, then one at x = 3 m for three, both orange.
void write_bag(const fs::path& folder) {
  log::BagWriter writer(folder, log::BagStorage::kMcap);
  const auto tf = writer.add_topic({"/tf_static", "tf2_msgs/msg/TFMessage"});
  const auto points = writer.add_topic({"/points", "sensor_msgs/msg/PointCloud2"});
  geometry_msgs::msg::TransformStamped stamped;
  stamped.header(convert::make_header(Stamp{}, "base_link"));
  stamped.child_frame_id("lidar");
  stamped.transform(convert::to_transform(Pose2{}));
  tf2_msgs::msg::TFMessage message;
  message.transforms({stamped});
  writer.write(tf, Stamp{}, convert::to_cdr(message));
  const auto scans = writer.add_topic({"/scan", "sensor_msgs/msg/LaserScan"});
  const auto odometry = writer.add_topic({"/odom", "nav_msgs/msg/Odometry"});
  Scan scan;  // what a replay goes by
  scan.angle_increment_rad = 0.1F;
  scan.range_max_m = 10.0F;
  scan.ranges_m.assign(20, 2.0F);
  for (int i = 0; i < 13; ++i) {
    const Stamp stamp = Stamp::from_seconds(i);
    scan.stamp = stamp;
    writer.write(odometry, stamp,
                 convert::to_cdr(convert::to_odometry(stamp, {}, "odom", "base_link")));
    writer.write(scans, stamp, convert::to_cdr(convert::to_message(scan, "base_link")));
    std::vector<Eigen::Vector3f> wall;
    for (int y = -5; y <= 5; ++y) {
      wall.emplace_back(i < 9 ? 2.05F : 3.05F, 0.1F * static_cast<float>(y) + 0.05F, 0.05F);
    }
    convert::CloudColumns columns;
    columns.rgb.assign(wall.size(), 0xFF8000);
    writer.write(points, stamp,
                 convert::to_cdr(convert::to_message(wall, stamp, "lidar", columns)));
  }
  writer.close();
}

volume::VolumeMap map_in(const fs::path& file) {
  return volume::VolumeMap::from_file(test::bytes_of(file), file.string());
}

bool is_occupied(const volume::VolumeMap& map, double x) {
  const auto log_odds = map.log_odds({x, 0.05, 0.05});
  return log_odds && map.is_occupied(*log_odds);
}

TEST(VolumeReplay, WritesColoursAndLevelsBesideTheMap) {
  const test::TemporaryDirectory folder;
  write_bag(folder.path() / "bag");
  std::ofstream(folder.path() / "volume.yaml")
      << "version: 1\ntransport: loopback\nprocesses:\n  - name: volume\n    components:\n"
         "      - {type: strata::VolumeMapper, name: volume_mapper, parameters: {has_levels: true, "
         "level_period_s: 0, map_frame: odom}}\n";
  const auto outcome = run_strata("replay " + quoted(folder.path() / "bag") + " --composition " +
                                  quoted(folder.path() / "volume.yaml") + " --quiet --out " +
                                  quoted(folder.path() / "out") + " 2>&1");
  ASSERT_EQ(outcome.code, 0) << outcome.out;
  const fs::path written = folder.path() / "out" / "volume";
  EXPECT_TRUE(is_occupied(map_in(written / "map_long.bt"), 2.05));
  EXPECT_FALSE(is_occupied(map_in(written / "map_short.bt"), 2.05));
  EXPECT_TRUE(is_occupied(map_in(written / "map_short.bt"), 3.05));
  ASSERT_TRUE(fs::exists(written / "map_mid.bt"));
  std::ifstream in(written / "map_color.ot", std::ios::binary);
  const std::unique_ptr<octomap::AbstractOcTree> read(octomap::AbstractOcTree::read(in));
  const auto* colored = dynamic_cast<octomap::ColorOcTree*>(read.get());
  ASSERT_NE(colored, nullptr);
  const octomap::ColorOcTreeNode* node = colored->search(3.05, 0.05, 0.05);
  ASSERT_NE(node, nullptr);
  EXPECT_EQ(node->getColor(), octomap::ColorOcTreeNode::Color(255, 128, 0));
}

}  // namespace
}  // namespace strata::tools
