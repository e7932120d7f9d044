// SPDX-License-Identifier: Apache-2.0
/// Mode robot: the frames have the log's own names.
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "components/convert/geometry_messages.hpp"
#include "components/convert/scan_messages.hpp"
#include "components/log/log_writer.hpp"
#include "tests/components/player/drive.hpp"
#include "tests/components/runtime/host_fixture.hpp"
#include "tests/support/test_data.hpp"

namespace strata::player {
namespace {

using sensor_msgs::msg::LaserScan;

const Pose2 kFront{0.2, 0.1, 0.0};
const Pose2 kRear{-0.3, 0.0, 3.0};

/// A scan a second, in "front_laser".
log::LogContent drive(int scans) {
  log::LogContent content;
  for (int i = 0; i < scans; ++i) {
    Observation observation;
    observation.scan.stamp = Stamp{1'000'000'000LL * (i + 1)};
    observation.scan.robot_from_laser = kFront;
    observation.scan.range_max_m = 10.0F;
    observation.scan.angle_increment_rad = 0.1F;
    observation.scan.ranges_m = {1.0F, 2.0F, 3.0F};
    content.observations.push_back(observation);
  }
  content.scan_frame = "front_laser";
  return content;
}

/// Half a second after each scan another one, of the scanner behind.
log::LogExtras scans_behind(const log::LogContent& content) {
  log::LogExtras extras;
  extras.mountings.push_back({"rear_laser", lift(kRear)});
  extras.topics.push_back({"/scan_rear", "sensor_msgs/msg/LaserScan", "cdr", log::recorded_qos()});
  for (const Observation& observation : content.observations) {
    Scan scan = observation.scan;
    scan.stamp = scan.stamp + Duration{500'000'000};
    extras.messages.push_back(
        {0, scan.stamp, convert::to_cdr(convert::to_message(scan, "rear_laser"))});
  }
  return extras;
}

struct Played {
  std::vector<LaserScan> scans;
  std::map<std::string, double> x_m;  ///< of each frame that tf_static knows at the end
};

Played play(const log::LogContent& content, const log::LogExtras& extras,
            const std::string& parameters, std::size_t count) {
  const test::TemporaryDirectory folder;
  log::write_bag(folder.path() / "bag", content, {.storage = log::BagStorage::kMcap}, extras);
  const auto participant = test::make_participant();
  test::Collector<LaserScan> scans(participant, "/scan", "lossless");
  test::Collector<tf2_msgs::msg::TFMessage> mountings(participant, "/tf_static", "tf_static");
  const auto host = test::play(folder.path() / "bag", parameters + ", rate: 1000000", participant);
  host->activate();
  Played played;
  played.scans = scans.wait_for(count);
  for (const auto& message : mountings.wait_for(1)) {
    for (const auto& transform : message.transforms()) {
      EXPECT_EQ(transform.header().frame_id(), "base_link");
      played.x_m[transform.child_frame_id()] = transform.transform().translation().x();
    }
  }
  return played;
}

TEST(PlayerFrames, AreThoseOfTheLog) {
  const Played played = play(drive(3), {}, "", 3);
  ASSERT_EQ(played.scans.size(), 3U);
  EXPECT_EQ(played.scans.front().header().frame_id(), "front_laser");
  EXPECT_EQ(played.x_m, (std::map<std::string, double>{{"front_laser", 0.2}}));
}

TEST(PlayerFrames, OfSeveralScannersAreThoseOfTheLog) {
  const log::LogContent content = drive(3);
  const Played played =
      play(content, scans_behind(content), ", scan_topics: [/scan, /scan_rear]", 6);
  ASSERT_EQ(played.scans.size(), 6U);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(played.scans[i].header().frame_id(), i % 2 == 0 ? "front_laser" : "rear_laser");
  }
  EXPECT_EQ(played.x_m,
            (std::map<std::string, double>{{"front_laser", 0.2}, {"rear_laser", -0.3}}));
}

}  // namespace
}  // namespace strata::player
