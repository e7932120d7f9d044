// SPDX-License-Identifier: Apache-2.0
/// No component keeps anything for the whole process: two instances of each, in two namespaces of
/// one process, do what one does alone. (Two players: tests/components/player.)
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "components/log/bag.hpp"
#include "tests/tools/strata/replay_fixture.hpp"

namespace fs = std::filesystem;

namespace strata::tools {
namespace {

using test::bytes_of;
using test::quoted;

class TwoInstances : public test::ReplayFixture {
 protected:
  void SetUp() override {
    ReplayFixture::SetUp();
    ASSERT_EQ(
        test::run_strata("localize --quiet " + quoted(log()) + " --maps " + quoted(at("direct")) +
                         " --initial-pose 0,0,0 --out " + quoted(at("localized")))
            .code,
        0);
    std::ofstream(at("times.txt")) << "1\n3\n5\n";
    ASSERT_EQ(test::run_strata("topology --quiet " + quoted(log()) + " --landmarks " +
                               quoted(at("times.txt")) + " --out " + quoted(at("topology")))
                  .code,
              0);
    write_composition();
    const test::Outcome outcome = replay(log(), at("two.yaml"), "two");
    ASSERT_EQ(outcome.code, 0) << outcome.out;
  }

  [[nodiscard]] fs::path bag(const std::string& scope) const { return at("bag_" + scope); }

  /// Topic by topic the messages that a recorder of one instance saw.
  [[nodiscard]] std::map<std::string, std::vector<std::vector<std::uint8_t>>> recorded(
      const std::string& scope) const {
    const auto reader = log::BagReader::open(bag(scope));
    std::map<std::string, std::vector<std::vector<std::uint8_t>>> messages;
    log::BagMessage message;
    while (reader->next(message)) {
      messages[reader->topics()[message.topic].name].push_back(message.data);
    }
    return messages;
  }

 private:
  void write_composition() const {
    std::ofstream file(at("two.yaml"));
    file << "version: 1\ntransport: loopback\nprocesses:\n  - name: p\n    components:\n";
    for (const std::string scope : {"a", "b"}) {
      const auto add = [&](const std::string& type, const std::string& parameters) {
        file << "      - {type: strata::" << type << ", name: " << type << ", namespace: /" << scope
             << ", remappings: {scan: /scan, odom: /odom, /tf: tf}, parameters: {" << parameters
             << "}}\n";
      };
      add("MapServer", "topic: served_map, map: " + (at("direct") / "filtered.yaml").string());
      add("ScanMatcher", "");
      add("BeamFilter", "");
      add("PatchLearner", "");
      add("TimescaleMemory", "");
      add("TopologyMapper", "mapping: {landmarks: {source: given}}, landmark_times_s: [1, 3, 5]");
      add("Localizer", "maps: " + at("direct").string() +
                           ", start: {pose: [0, 0, 0]}, out_subfolder: localization");
      add("Recorder", "out: " + bag(scope).string() +
                          ", topics: ['served_map:nav_msgs/msg/OccupancyGrid', "
                          "'scan_pose:strata_msgs/msg/ScanPose', "
                          "'scan_static:sensor_msgs/msg/LaserScan', "
                          "'patch_map:strata_msgs/msg/PatchMap', "
                          "'node_map:strata_msgs/msg/NodeMap', "
                          "'topologies:strata_msgs/msg/Topologies', "
                          "'amcl_pose:geometry_msgs/msg/PoseWithCovarianceStamped']");
    }
  }
};

TEST_F(TwoInstances, OfEveryComponentInOneProcessDoWhatOneDoesAlone) {
  for (const std::string scope : {"a", "b"}) {
    const fs::path localized = at("two") / scope / "localization";
    for (const char* file : {"trajectory.tum", "states.csv"}) {
      EXPECT_EQ(bytes_of(localized / file), bytes_of(at("localized") / file)) << scope << file;
      EXPECT_FALSE(bytes_of(localized / file).empty());
    }
    fs::remove_all(localized);
    test::expect_same_topologies(at("topology"), at("two") / scope / "topology");
    fs::remove_all(at("two") / scope / "topology");
    test::expect_same_maps(at("direct"), at("two") / scope);
  }
  const auto a = recorded("a");
  const auto b = recorded("b");
  ASSERT_EQ(a.size(), 7U);
  const std::size_t scans = a.at("/a/scan_pose").size() - 1;  // the last one's twice
  EXPECT_GT(scans, 10U);
  EXPECT_EQ(a.at("/a/scan_static").size(), scans);
  EXPECT_EQ(a.at("/a/amcl_pose").size(), scans);
  EXPECT_EQ(a.at("/a/served_map").size(), 1U);
  EXPECT_EQ(a.at("/a/patch_map").size(), 1U);
  EXPECT_EQ(a.at("/a/node_map").size(), 1U);
  EXPECT_EQ(a.at("/a/topologies").size(), 3U);  // one a landmark
  for (const auto& [topic, messages] : a) {
    const auto other = b.find("/b" + topic.substr(2));
    ASSERT_NE(other, b.end()) << topic;
    EXPECT_TRUE(other->second == messages) << topic;
  }
}

}  // namespace
}  // namespace strata::tools
