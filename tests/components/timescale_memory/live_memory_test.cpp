// SPDX-License-Identifier: Apache-2.0
/// The memory of running robots, over DDS.
#include "tests/components/timescale_memory/live_memory.hpp"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "components/bus/text_message.hpp"
#include "components/site/learn_limits.hpp"
#include "core/grid/blind_beams.hpp"
#include "tests/memory/store/execute_sql.hpp"

namespace strata::timescale_memory {
namespace {

/// The k-th scan of a robot in its end of the room, at 2 Hz.
PosedScan scan_of(int robot, int k) {
  const double x = robot == 0 ? -2.5 : 1.0;
  return observe({x + 0.4 * std::sin(0.3 * k), 0.4, 0.3 * k}, 1000.0 + 0.5 * k, false,
                 static_cast<std::uint64_t>(robot + 1));
}

/// Who sends when.
using Order = std::vector<std::pair<int, int>>;  // robot, which of its scans

class OneMemoryForTwoRobots : public LiveMemoryTest, public testing::WithParamInterface<int> {
 protected:
  static constexpr int kScans = 40;
  [[nodiscard]] static Order order() {
    Order order;
    for (int k = 0; k < kScans; ++k) {
      for (int robot = 0; robot < 2; ++robot) order.emplace_back(robot, k);
    }
    RandomStream random(5, StreamId::kTest);
    if (GetParam() == 1) {  // one after the other
      std::stable_sort(order.begin(), order.end(),
                       [](const auto& a, const auto& b) { return a.first < b.first; });
    } else if (GetParam() == 2) {  // the second late, and its scans backwards
      std::stable_sort(order.begin(), order.end(), [](const auto& a, const auto& b) {
        return a.first != b.first ? a.first < b.first : a.first == 1 && a.second > b.second;
      });
    } else if (GetParam() == 3) {  // as it happens
      for (std::size_t i = order.size(); i > 1; --i) {
        std::swap(order[i - 1], order[random.below(static_cast<std::uint32_t>(i))]);
      }
    }
    return order;
  }
};

TEST_P(OneMemoryForTwoRobots, LosesNoScanOfEither) {
  {
    LiveMemory memory("store: '" + path() + "', robots: [robot1, /robot2]");
    Robot one("/robot1/labeled_scan");
    Robot two("/robot2/labeled_scan");
    for (const auto& [robot, k] : order()) (robot == 0 ? one : two).publish(scan_of(robot, k));
    ASSERT_TRUE(memory.has_received("/robot1/labeled_scan", kScans));
    ASSERT_TRUE(memory.has_received("/robot2/labeled_scan", kScans));
  }
  // A robot turns by more than the gate asks for between two scans: each of them counts.
  const TimescaleMemory memory = stored();
  std::uint64_t left = 0;
  std::uint64_t right = 0;
  for (const memory::MemoryNode& node : memory.nodes()) {
    (node.position_m.x() < -0.8 ? left : right) += node.observations;
  }
  EXPECT_EQ(left, static_cast<std::uint64_t>(kScans));
  EXPECT_EQ(right, static_cast<std::uint64_t>(kScans));
  // Each of them as if it had been there alone.
  for (int robot = 0; robot < 2; ++robot) {
    const Pose2 laser{robot == 0 ? -2.5 : 1.0, 0.4, 0.0};
    const float expected = memory.decode()->expected_range_m(2, laser, 1.0);
    EXPECT_NEAR(expected, memory::test_world::range_m(laser.translation(), 1.0, false), 0.1);
  }
}

INSTANTIATE_TEST_SUITE_P(InAnyOrder, OneMemoryForTwoRobots, testing::Range(0, 4));

TEST_F(LiveMemoryTest, GoesOnAfterARestartAsIfNothingHadHappened) {
  TimescaleMemory uninterrupted({}, 1);
  for (int part = 0; part < 3; ++part) {
    LiveMemory memory("store: '" + path() + "', resident_nodes: 1");
    Robot robot("/labeled_scan");
    for (int k = 20 * part; k < 20 * (part + 1); ++k) {
      robot.publish(scan_of(0, k));
      uninterrupted.observe(scan_of(0, k));
    }
    ASSERT_TRUE(memory.has_received("/labeled_scan", 20));
  }
  EXPECT_EQ(stored().state(), uninterrupted.state());
}

TEST_F(LiveMemoryTest, LearnsNothingOfZonesThatForbidIt) {
  const std::string zones = path() + ".geojson";
  std::ofstream(zones) << R"({"type": "FeatureCollection", "features": [
    {"type": "Feature", "properties": {"name": "a", "kind": "learn", "control": "never_learn"},
     "geometry": {"type": "Polygon",
                  "coordinates": [[[-9, 0.6], [9, 0.6], [9, 9], [-9, 9], [-9, 0.6]]]}}]})";
  const Grid<std::uint8_t> cells = site::learn_limits(site::zones_at(zones), 0.05).never;
  TimescaleMemory blind({}, 1);
  std::size_t beams = 0;
  std::size_t blinded = 0;
  {
    LiveMemory memory("store: '" + path() + "', zones: '" + zones + "'");
    Robot robot("/labeled_scan");
    for (int k = 0; k < 20; ++k) {
      PosedScan scan = scan_of(0, k);
      robot.publish(scan);
      beams += scan.scan.size();
      blinded += blind_beams(scan, cells);
      blind.observe(scan);
    }
    ASSERT_TRUE(memory.has_received("/labeled_scan", 20));
  }
  EXPECT_GT(blinded, beams / 4);
  EXPECT_LT(blinded, beams);
  EXPECT_EQ(stored().state(), blind.state());
}

TEST_F(LiveMemoryTest, PublishesWhichPlacesHaveChanged) {
  LiveMemory memory("changes_period_s: 1.0");
  test::Collector<std_msgs::msg::String> lists(test::make_participant(), "/changed_places",
                                               "lossless");
  Robot robot("/labeled_scan");
  // The box comes after 400 s.
  for (int k = 0; k < 415; ++k) {
    const Pose2 pose{0.3 * std::sin(0.7 * k), 0.3 * std::cos(0.7 * k), 0.1 * k};
    robot.publish(observe(pose, k, k >= 400));
  }
  ASSERT_TRUE(memory.has_received("/labeled_scan", 415));
  // At most one list a second of the robot's, and one in twenty of the process's, comes: the last
  // scans may have none.
  nlohmann::json list;
  for (int k = 415; k < 1000 && (list.is_null() || list["places"].empty()); ++k) {
    const std::size_t before = lists.wait_for(0).size();
    const Pose2 pose{0.3 * std::sin(0.7 * k), 0.3 * std::cos(0.7 * k), 0.1 * k};
    robot.publish(observe(pose, k, true));
    const auto seen = lists.wait_for(before + 1, std::chrono::milliseconds(100));
    if (!seen.empty()) list = nlohmann::json::parse(seen.back().data());
  }
  EXPECT_EQ(list["before"], "long");
  EXPECT_EQ(list["now"], "short");
  EXPECT_EQ(list["frame"], "map");
  ASSERT_FALSE(list["places"].empty());
  EXPECT_EQ(list["places"][0]["kind"], "appeared");
  EXPECT_NEAR(list["places"][0]["center"][0].get<double>(), 2.0, 0.3);
}

TEST_F(LiveMemoryTest, PublishesWhatTheStoreHoldsFromTheFirstScanOn) {
  {
    TimescaleMemory memory({}, 1);
    for (int k = 0; k < 40; ++k) {
      memory.observe(scan_of(0, k));
      memory.observe(scan_of(1, k));
    }
    memory::Store(path()).save_timescale(memory);
  }
  const std::size_t nodes = stored().nodes().size();
  ASSERT_GT(nodes, 1U);
  LiveMemory memory("store: '" + path() + "'");
  test::Collector<strata_msgs::msg::NodeMap> maps(test::make_participant(), "/node_map", "latched");
  Robot robot("/labeled_scan");
  robot.publish(scan_of(0, 40));
  const auto received = maps.wait_for(1);
  ASSERT_EQ(received.size(), 1U);
  EXPECT_EQ(received[0].nodes().size(), nodes);
}

TEST_F(LiveMemoryTest, GoesOnThoughANodeOfItsStoreIsDamaged) {
  {
    TimescaleMemory memory({}, 1);
    for (int k = 0; k < 40; ++k) {
      memory.observe(scan_of(0, k));
      memory.observe(scan_of(1, k));
    }
    memory::Store(path()).save_timescale(memory);
  }
  // Where the robot is.
  const std::size_t nodes = stored().nodes().size();
  const int here = stored().observe(scan_of(0, 40)).node;
  const std::string query =
      "UPDATE timescale_level SET data = substr(data, 1, length(data) - 1) "
      "|| x'5a' WHERE node = " +
      std::to_string(here);
  test::execute(path(), query.c_str());
  for (int start = 0; start < 2; ++start) {
    LiveMemory memory("store: '" + path() + "'");
    test::Collector<strata_msgs::msg::NodeMap> maps(test::make_participant(), "/node_map",
                                                    "latched");
    Robot robot("/labeled_scan");
    robot.publish(scan_of(0, 40 + 10 * start));
    auto received = maps.wait_for(1);
    ASSERT_FALSE(received.empty());
    EXPECT_EQ(received[0].nodes().size(), nodes - 1 + static_cast<std::size_t>(start));
    const auto status = memory.status("nodes damaged", "1");
    EXPECT_THAT(status.message(), testing::HasSubstr("node " + std::to_string(here) + " at ("));
    EXPECT_THAT(status.message(), testing::HasSubstr("backup"));
    robot.publish(scan_of(0, 44 + 10 * start));  // it learns the place anew
    ASSERT_TRUE(memory.has_received("/labeled_scan", 2));
  }
  EXPECT_EQ(memory::Store(path()).open_timescale().nodes().size(), nodes + 1);
}

}  // namespace
}  // namespace strata::timescale_memory
