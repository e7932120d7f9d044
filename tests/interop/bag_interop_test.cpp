// SPDX-License-Identifier: Apache-2.0
/// What we write opens in libraries that others made, and we read what they write.
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "strata_idl/diagnostic_msgs.h"
#include "strata_idl/nav2_msgs.h"
#include "strata_idl/nav_msgs.h"
#include "strata_idl/octomap_msgs.h"
#include "strata_idl/rmw_dds_common.h"
#include "strata_idl/rosgraph_msgs.h"
#include "strata_idl/sensor_msgs.h"
#include "strata_idl/strata_msgs.h"
#include "strata_idl/tf2_msgs.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <yaml-cpp/yaml.h>

#include "components/convert/cdr.hpp"
#include "components/log/bag.hpp"
#include "components/log/log_reader.hpp"
#include "components/log/log_writer.hpp"
#include "tests/support/command.hpp"
#include "tests/support/test_data.hpp"

namespace fs = std::filesystem;

namespace strata::log {
namespace {

using Json = nlohmann::json;
using test::Outcome;
using test::quoted;
using test::run_command;

class BagInterop : public ::testing::Test {
 protected:
  void SetUp() override {
    const Outcome ready = run_command(quoted(fs::path(STRATA_INTEROP_SOURCE) / "prepare") + " " +
                                      quoted(STRATA_INTEROP_DIR));
    if (ready.code == 3) GTEST_SKIP() << ready.out;
    ASSERT_EQ(ready.code, 0) << ready.out;
  }
  Json tool(const std::string& arguments) {
    const Outcome outcome = run_command(
        "node " + quoted(fs::path(STRATA_INTEROP_DIR) / "bag_tool.mjs") + " " + arguments);
    EXPECT_EQ(outcome.code, 0) << outcome.out;
    return outcome.code == 0 ? Json::parse(outcome.out) : Json::object();
  }
  strata::test::TemporaryDirectory folder_;
};

/// One message of a type on a topic of its own.
struct Sample {
  std::string topic;
  std::string type;
  std::vector<std::uint8_t> cdr;
};

template <typename Message>
Sample sample(const std::string& package, const std::string& name, const Message& message) {
  return {"/" + package + "/" + name, package + "/msg/" + name, convert::to_cdr(message)};
}

sensor_msgs::msg::LaserScan laser_scan() {
  sensor_msgs::msg::LaserScan scan;
  scan.header().stamp().sec(7);
  scan.header().stamp().nanosec(500);
  scan.header().frame_id("laser");
  scan.angle_min(-1.5F);
  scan.range_max(30.0F);
  scan.ranges({1.0F, 0.1F, 2.5F});
  return scan;
}

strata_msgs::msg::PatchMap patch_map() {
  strata_msgs::msg::Configuration configuration;
  configuration.prior(0.25);
  configuration.reflection().reflection({0.5F, 1.0F});
  configuration.counts().hits({1.0, 2.0, 3.0});
  strata_msgs::msg::ObservationSequence sequence;
  sequence.scans(123456789012ULL);
  sequence.membership({0.75, 0.25});
  strata_msgs::msg::Submap submap;
  submap.id(-3);
  submap.contradictory({1, 0, 1});
  submap.configurations({configuration, configuration});
  submap.sequences({sequence});
  strata_msgs::msg::PatchMap map;
  map.header().frame_id("map");
  map.base().resolution(0.1);
  map.submaps({submap});
  return map;
}

diagnostic_msgs::msg::DiagnosticArray diagnostics() {
  diagnostic_msgs::msg::KeyValue value;
  value.key("rate");
  value.value("7.7 Hz");
  diagnostic_msgs::msg::DiagnosticStatus status;
  status.level(2);
  status.name("localizer");
  status.values({value, value});
  diagnostic_msgs::msg::DiagnosticArray array;
  array.status({status});
  return array;
}

std::vector<Sample> samples() {
  strata_msgs::msg::MemoryNode node;
  node.levels().resize(2);
  node.levels()[1].name("minutes");
  node.levels()[1].ranges({1.0F, 2.0F});
  strata_msgs::msg::NodeMap nodes;
  nodes.nodes({node});
  strata_msgs::msg::SubmapStates states;
  states.states().resize(1);
  states.states()[0].probability({0.5, 0.5});
  strata_msgs::msg::Step step;
  step.kind(strata_msgs::msg::STEP_FINISH);
  step.target("localizer");
  strata_msgs::msg::Ack ack;
  ack.ok(true);
  ack.published().resize(1);
  ack.published()[0].topic("/map");
  strata_msgs::msg::Trajectory trajectory;
  trajectory.run({1, 2});
  trajectory.labels().resize(1);
  strata_msgs::msg::Topologies topologies;
  topologies.topologies().resize(2);
  topologies.topologies()[1].labels({0, 1, 0});
  nav_msgs::msg::OccupancyGrid grid;
  grid.data({0, 100, -1});
  tf2_msgs::msg::TFMessage transforms;
  transforms.transforms().resize(2);
  octomap_msgs::msg::Octomap octomap;
  octomap.data({-1, 5});
  nav2_msgs::msg::ParticleCloud cloud;
  cloud.particles().resize(2);
  return {sample("sensor_msgs", "LaserScan", laser_scan()),
          sample("strata_msgs", "PatchMap", patch_map()),
          sample("diagnostic_msgs", "DiagnosticArray", diagnostics()),
          sample("strata_msgs", "NodeMap", nodes),
          sample("strata_msgs", "SubmapStates", states),
          sample("strata_msgs", "Step", step),
          sample("strata_msgs", "Ack", ack),
          sample("strata_msgs", "Topologies", topologies),
          sample("strata_msgs", "Trajectory", trajectory),
          sample("strata_msgs", "LabeledScan", strata_msgs::msg::LabeledScan()),
          sample("strata_msgs", "LocalizationHealth", strata_msgs::msg::LocalizationHealth()),
          sample("nav_msgs", "OccupancyGrid", grid),
          sample("nav_msgs", "Odometry", nav_msgs::msg::Odometry()),
          sample("tf2_msgs", "TFMessage", transforms),
          sample("octomap_msgs", "Octomap", octomap),
          sample("nav2_msgs", "ParticleCloud", cloud),
          sample("rosgraph_msgs", "Clock", rosgraph_msgs::msg::Clock()),
          sample("geometry_msgs", "PointStamped", geometry_msgs::msg::PointStamped()),
          sample("geometry_msgs", "PoseWithCovarianceStamped",
                 geometry_msgs::msg::PoseWithCovarianceStamped()),
          sample("rmw_dds_common", "ParticipantEntitiesInfo",
                 rmw_dds_common::msg::ParticipantEntitiesInfo())};
}

TEST_F(BagInterop, McapsOpenInTheMcapLibraryAndEveryTypeDecodesByItsSchema) {
  const std::vector<Sample> all = samples();
  const std::pair<BagCompression, const char*> cases[] = {
      {BagCompression::kNone, ""}, {BagCompression::kZstd, "zstd"}, {BagCompression::kLz4, "lz4"}};
  for (const auto& [compression, name] : cases) {
    const fs::path bag = folder_.path() / (std::string("bag") + name);
    BagWriter writer(bag, BagStorage::kMcap, compression);
    for (std::size_t i = 0; i < 3 * all.size(); ++i) {
      const Sample& one = all[i % all.size()];
      const auto topic = writer.add_topic({one.topic, one.type, "cdr", recorded_qos()});
      writer.write(topic, {static_cast<std::int64_t>(1'000'000'000 + i)}, one.cdr);
    }
    writer.add_topic({"/silent", "std_msgs/msg/String", "cdr", ""});
    writer.close();
    const Json read = tool("read-mcap " + quoted(bag / (bag.filename().string() + "_0.mcap")));
    EXPECT_EQ(read["profile"], "ros2");
    EXPECT_EQ(read["complete"], true);
    EXPECT_EQ(read["streamed"], 3 * all.size()) << "every checksum fits";
    EXPECT_THAT(read["chunks"], ::testing::Each(name));
    // rosbag2 reads the information itself there, without the key above it that metadata.yaml has.
    const YAML::Node kept =
        YAML::Load(read["metadata"]["rosbag2"]["serialized_metadata"].get<std::string>());
    const YAML::Node file = YAML::LoadFile((bag / "metadata.yaml").string());
    EXPECT_EQ(kept["version"].as<int>(0), 7);
    EXPECT_EQ(YAML::Dump(kept), YAML::Dump(file["rosbag2_bagfile_information"]));
    EXPECT_EQ(read["metadataCount"], 1);
    ASSERT_EQ(read["messages"].size(), 3 * all.size());
    EXPECT_EQ(read["topics"].size(), all.size() + 1);
    for (std::size_t i = 0; i < read["messages"].size(); ++i) {
      const Json& message = read["messages"][i];
      const Sample& one = all[i % all.size()];
      EXPECT_EQ(message["topic"], one.topic);
      EXPECT_EQ(message["time"], std::to_string(1'000'000'000 + i));
      EXPECT_EQ(message["same"], true) << one.type << ": " << message["value"].dump();
      EXPECT_EQ(read["topics"][one.topic]["type"], one.type);
      EXPECT_EQ(read["topics"][one.topic]["encoding"], "ros2msg");
      EXPECT_EQ(read["topics"][one.topic]["qos"], recorded_qos());
      EXPECT_EQ(read["topics"][one.topic]["count"], "3");
    }
    const Json& scan = read["messages"][0]["value"];
    EXPECT_EQ(scan["header"]["frame_id"], "laser");
    EXPECT_EQ(scan["ranges"][1].get<float>(), 0.1F);
    const Json& submap = read["messages"][1]["value"]["submaps"][0];
    EXPECT_EQ(submap["id"], -3);
    EXPECT_EQ(submap["configurations"][1]["prior"], 0.25);
    EXPECT_EQ(submap["sequences"][0]["scans"], "123456789012");
    EXPECT_EQ(read["messages"][2]["value"]["status"][0]["values"][1]["value"], "7.7 Hz");
    EXPECT_EQ(read["messages"][5]["value"]["kind"], 3);
  }
}

TEST_F(BagInterop, DatabasesOfBothSchemasOpenInTheRosbag2LibrarySplitOrWhole) {
  for (const int schema : {3, 4}) {
    const fs::path bag = folder_.path() / ("bag" + std::to_string(schema));
    BagWriter writer(bag, BagOptions{.sqlite_schema = schema, .split_bytes = 500});
    const auto scan =
        writer.add_topic({"/scan", "sensor_msgs/msg/LaserScan", "cdr", recorded_qos()});
    const auto tf =
        writer.add_topic({"/tf_static", "tf2_msgs/msg/TFMessage", "cdr", recorded_qos(true)});
    tf2_msgs::msg::TFMessage transforms;
    transforms.transforms().resize(1);
    writer.write(tf, {1'000'000'000}, convert::to_cdr(transforms));
    for (int i = 1; i <= 20; ++i) {
      writer.write(scan, {1'000'000'000 + i}, convert::to_cdr(laser_scan()));
    }
    writer.close();
    std::string files;
    std::size_t count = 0;
    for (; fs::exists(bag / (bag.filename().string() + "_" + std::to_string(count) + ".db3"));
         ++count) {
      files += " " + quoted(bag / (bag.filename().string() + "_" + std::to_string(count) + ".db3"));
    }
    EXPECT_GT(count, 2U);
    const Json read = tool("read-db3" + files);
    ASSERT_EQ(read["messages"].size(), 21U);
    EXPECT_EQ(read["topics"]["/scan"]["type"], "sensor_msgs/msg/LaserScan");
    EXPECT_EQ(read["topics"]["/scan"]["count"], 20);
    EXPECT_EQ(read["topics"]["/tf_static"]["qos"][0]["durability"], 1);
    EXPECT_EQ(read["messages"][20]["value"]["ranges"][2].get<float>(), 2.5F);
    EXPECT_EQ(read["messages"][20]["time"]["nsec"], 20);
  }
}

TEST_F(BagInterop, WhatTheMcapLibraryWritesReadsHere) {
  for (const std::string compression : {"none", "zstd"}) {
    const fs::path file = folder_.path() / (compression + ".mcap");
    ASSERT_EQ(tool("write-mcap " + quoted(file) + " " + compression)["written"], 100);
    const auto reader = BagReader::open(file);
    ASSERT_EQ(reader->topics().size(), 1U);
    EXPECT_EQ(reader->topics()[0].offered_qos_profiles, "- history: 3");
    ReadReport report;
    const auto scans = read_observations(file, {}, &report);
    ASSERT_EQ(scans.size(), 100U);
    EXPECT_EQ(report.bad_lines, 0U) << report.first_bad;
    EXPECT_EQ(scans[99].scan.stamp.ns, 199'000'000'500);
    EXPECT_THAT(scans[99].scan.ranges_m, ::testing::ElementsAre(100.0F, 2.0F, 3.0F, 4.0F, 5.0F));
  }
}

}  // namespace
}  // namespace strata::log
