// SPDX-License-Identifier: Apache-2.0
#include <fstream>
#include <vector>

#include <gtest/gtest.h>

#include "components/convert/scan_messages.hpp"
#include "tests/components/log/ros1_bag_maker.hpp"
#include "tests/components/player/drive.hpp"
#include "tests/components/runtime/host_fixture.hpp"
#include "tests/support/test_data.hpp"

namespace strata::player {
namespace {

using sensor_msgs::msg::LaserScan;

TEST(PlayerOfRos1Bags, PlaysWhatRos2HasAndLeavesTheRestOut) {
  const test::TemporaryDirectory folder;
  const auto bag = folder.path() / "drive.bag";
  log::test_log::Ros1BagMaker maker({.compression = "lz4"});
  std::vector<LaserScan> recorded;
  for (std::int64_t i = 1; i <= 3; ++i) {
    Scan scan;
    scan.stamp = {i * 1'000'000'000};
    scan.range_max_m = 30.0F;
    scan.ranges_m = {1.0F, 2.0F, static_cast<float>(i)};
    recorded.push_back(convert::to_message(scan, "laser"));
    maker.write(log::test_log::kRos1Scan, scan.stamp,
                log::test_log::ros1_message(recorded.back(), 0));
    maker.write({"/weld", "acme_msgs/Weld", "0123456789abcdef0123456789abcdef"}, scan.stamp, "ab");
  }
  std::ofstream(bag, std::ios::binary) << maker.finish();
  const auto participant = test::make_participant();
  test::Collector<LaserScan> scans(participant, "/scan", "lossless");
  const auto host = test::play(bag, ", mode: messages, rate: 1000000", participant);
  host->activate();
  EXPECT_EQ(scans.wait_for(3), recorded);
  EXPECT_EQ(participant->published_topics().count("/weld"), 0U);
  EXPECT_TRUE(host->take_errors().empty());
}

}  // namespace
}  // namespace strata::player
