// SPDX-License-Identifier: Apache-2.0
/// Ways that an older version wrote.
#include "components/topology_mapper/mapper_store.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "memory/store/store.hpp"
#include "tests/components/topology_mapper/niche_room.hpp"
#include "tests/support/test_data.hpp"

namespace strata::topology_mapper {
namespace {

using test::kStepS;
using test::Moment;

constexpr std::size_t kDriven = 10;
constexpr int kStood = 5;
constexpr topology::PathKeepConfig kKeep{0.05, 0.05, 0.0};
/// Where the odometry's frame lies: an older version's store holds a pose of its own.
const Pose2 kOdomFromMap{3.0, -1.0, 0.7};

Observation observed(const Moment& moment) {
  Observation observation;
  observation.scan = test::scan_at(moment);
  observation.odom_from_robot = kOdomFromMap * moment.pose;
  return observation;
}

class OlderStore : public testing::Test {
 protected:
  /// As versions wrote it that kept every scan, also of a robot that stood, and the odometry of the
  /// newest: "null" without.
  OlderStore() {
    memory::Store store(file());
    topology::TopologyMapper mapper({});
    const std::vector<Moment> drive = test::there_and_back();
    for (std::size_t i = 0; i < kDriven; ++i) (void)mapper.add(observed(drive[i]));
    std::vector<PosedScan> scans = mapper.scans();
    for (int i = 0; i < kStood; ++i) {
      scans.push_back(scans.back());
      scans.back().scan.stamp = scans.back().scan.stamp + Duration::from_seconds(kStepS);
    }
    store.append_scans(0, scans);
    newest_ = scans.back();
    odometry_ = mapper.newest()->odom_from_robot.value();
  }
  void save_odometry(const std::string& text) const {
    memory::Store(file()).save_text("topology/odometry", text);
  }
  [[nodiscard]] std::string odometry() const {
    const auto number = [](double value) { return nlohmann::json(value).dump(); };
    return "[" + number(odometry_.x) + "," + number(odometry_.y) + "," + number(odometry_.theta) +
           "]";
  }
  /// How far on the robot is taken to be a metre further by its odometry.
  [[nodiscard]] double comes_on_m(const topology::TrackedMoment& restored) {
    mapper_.resume_from(restored);
    Moment further{newest_.scan.stamp.seconds() + kStepS, test::there_and_back()[kDriven - 1].pose};
    further.pose = further.pose * Pose2{1.0, 0.0, 0.0};
    (void)mapper_.add(observed(further));
    return translation_distance(newest_.map_from_robot, mapper_.newest()->map_from_robot);
  }
  [[nodiscard]] std::filesystem::path file() const { return folder_.path() / "way.db"; }

  const test::TemporaryDirectory folder_;
  PosedScan newest_;
  Pose2 odometry_;
  topology::TopologyMapper mapper_{{}, 1, 1, kKeep};
};

TEST_F(OlderStore, IsGoneOnFromWithTheOdometryOfItsNewestScan) {
  save_odometry(odometry());
  const auto restored = MapperStore(file()).restore(mapper_);
  ASSERT_TRUE(restored.has_value());
  EXPECT_EQ(restored->stamp, newest_.scan.stamp);
  EXPECT_EQ(restored->map_from_robot, newest_.map_from_robot);
  ASSERT_TRUE(restored->odom_from_robot.has_value());
  EXPECT_EQ(*restored->odom_from_robot, odometry_);
  EXPECT_EQ(mapper_.scans().size(), kDriven) << "it stood";
  EXPECT_NEAR(comes_on_m(*restored), 1.0, 0.05);
}

TEST_F(OlderStore, OfARobotWithoutOdometryIsGoneOnFromWhereItStood) {
  save_odometry("null");
  const auto restored = MapperStore(file()).restore(mapper_);
  ASSERT_TRUE(restored.has_value());
  EXPECT_EQ(restored->stamp, newest_.scan.stamp);
  EXPECT_FALSE(restored->odom_from_robot.has_value());
  EXPECT_NEAR(comes_on_m(*restored), 0.0, 0.05);
}

TEST_F(OlderStore, YieldsToWhatThisVersionWroteSince) {
  save_odometry(odometry());
  const Pose2 since{4.0, 5.0, 0.6};
  {
    MapperStore store(file());
    auto newest = store.restore(mapper_);
    ASSERT_TRUE(newest.has_value());
    newest->stamp = newest->stamp + Duration::from_seconds(kStepS);
    newest->odom_from_robot = since;
    store.came_to(*newest);
    store.flush();
  }
  topology::TopologyMapper again({}, 1, 1, kKeep);
  const auto restored = MapperStore(file()).restore(again);
  ASSERT_TRUE(restored.has_value());
  ASSERT_TRUE(restored->odom_from_robot.has_value());
  EXPECT_EQ(*restored->odom_from_robot, since);
}

}  // namespace
}  // namespace strata::topology_mapper
