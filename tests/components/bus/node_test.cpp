// SPDX-License-Identifier: Apache-2.0
/// The graph that `ros2 node list` reads.
#include "components/bus/node.hpp"

#include <algorithm>

#include "strata_idl/rmw_dds_common.h"
#include "strata_idl/rmw_dds_common_24.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/bus/graph_message.hpp"
#include "components/convert/type_hash.hpp"
#include "core/base/error.hpp"
#include "tests/components/bus/domain.hpp"

namespace strata::bus {
namespace {

using std::chrono::seconds;

Guid guid_of(std::uint8_t number) {
  Guid guid{};
  for (std::size_t i = 0; i < guid.size(); ++i) guid[i] = static_cast<std::uint8_t>(number + i);
  return guid;
}

const std::vector<NodeInfo> kNodes = {
    {"/", "localizer", {guid_of(1), guid_of(2)}, {guid_of(3)}},
    {"/robot1", "map_server", {}, {}},
};

TEST(GraphMessage, ComesBackInBothLayouts) {
  for (const std::size_t gid_bytes : {16U, 24U}) {
    const auto bytes = graph_to_cdr(guid_of(9), kNodes, gid_bytes);
    const auto graph = graph_from_cdr(bytes);
    ASSERT_TRUE(graph.has_value()) << gid_bytes;
    EXPECT_EQ(graph->first, guid_of(9));
    EXPECT_EQ(graph->second, kNodes);
  }
}

TEST(GraphMessage, HasTheBytesOfRos2) {
  // One node of an empty name in "/", no endpoints: a Gid, a count, two strings, two counts.
  const auto bytes = graph_to_cdr(guid_of(1), {{"/", "", {}, {}}}, 16);
  const std::vector<std::uint8_t> expected = {0, 1, 0, 0,  1,   2,  3,  4,  5,  6,
                                              7, 8, 9, 10, 11,  12, 13, 14, 15, 16,  //
                                              1, 0, 0, 0,                            //
                                              2, 0, 0, 0,  '/', 0,  0,  0,           //
                                              1, 0, 0, 0,  0,   0,  0,  0,           //
                                              0, 0, 0, 0,  0,   0,  0,  0};
  EXPECT_EQ(bytes, expected);
  EXPECT_EQ(graph_to_cdr(guid_of(1), {}, 24).size(), 4U + 24U + 4U);
}

TEST(GraphMessage, RefusesDamageWithoutTakingMemoryForIt) {
  auto bytes = graph_to_cdr(guid_of(9), kNodes, 16);
  for (std::size_t length = 0; length + 4 < bytes.size(); ++length) {
    (void)graph_from_cdr({bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(length)});
  }
  // Claims 4 billion nodes.
  for (std::size_t i = 20; i < 24; ++i) bytes[i] = 0xFF;
  EXPECT_FALSE(graph_from_cdr(bytes).has_value());
}

TEST(Graph, ShowsOthersTheNodesAndTheirEndpoints) {
  const auto here = test::make_participant();
  const auto there = test::make_participant();
  RawWriter writer(here, "/scan", "sensor_msgs/msg/LaserScan", qos_profile("default"));
  auto first = std::make_unique<Node>(here, "/robot1", "first");
  first->announce({}, {writer.guid()});
  const Node second(here, "", "second");
  const GraphReader reader(there);  // comes late
  ASSERT_TRUE(reader.wait_for_node("/second", seconds(20)));
  ASSERT_TRUE(reader.wait_for_node("/robot1/first", seconds(20)));
  const auto nodes = reader.nodes().at(here->guid());
  ASSERT_EQ(nodes.size(), 2U);
  const auto found = std::find_if(nodes.begin(), nodes.end(),
                                  [](const NodeInfo& node) { return node.name == "first"; });
  ASSERT_NE(found, nodes.end());
  EXPECT_THAT(found->writers, testing::ElementsAre(writer.guid()));
}

TEST(Graph, ForgetsANodeThatEnds) {
  const auto here = test::make_participant();
  const auto there = test::make_participant();
  const GraphReader reader(there);
  auto first = std::make_unique<Node>(here, "/", "first");
  ASSERT_TRUE(reader.wait_for_node("/first", seconds(20)));
  first.reset();
  const Node last(here, "/", "last");
  ASSERT_TRUE(reader.wait_for_node("/last", seconds(20)));
  EXPECT_FALSE(reader.wait_for_node("/first", std::chrono::milliseconds(0)));
}

TEST(Graph, HasLongGidsUpToHumbleAndShortOnesAfter) {
  EXPECT_EQ(gid_bytes_of("humble"), 24U);
  EXPECT_EQ(gid_bytes_of("iron"), 16U);
  EXPECT_EQ(gid_bytes_of("jazzy"), 16U);
  EXPECT_THROW((void)gid_bytes_of("noetic"), ConfigError);
}

std::string hash_seen_from(const Participant& participant, const Guid& guid) {
  for (const DiscoveredEndpoint& endpoint : participant.view().endpoints) {
    if (endpoint.guid == guid) return endpoint.type_hash;
  }
  return "not seen";
}

TEST(Discovery, ShowsParticipantsAndEndpointsOfBothSides) {
  const auto here = test::make_participant();
  const auto there = test::make_participant();
  RawWriter writer(there, "/map", "nav_msgs/msg/OccupancyGrid", qos_profile("latched"));
  RawReader reader(here, "/map", "nav_msgs/msg/OccupancyGrid", qos_profile("latched"),
                   [](const RawMessage&) {});
  ASSERT_TRUE(reader.wait_for_writers(1, seconds(20)));
  ASSERT_TRUE(writer.wait_for_readers(1, seconds(20)));
  const DomainView view = here->view();
  const auto participant =
      std::find_if(view.participants.begin(), view.participants.end(),
                   [&](const auto& entry) { return entry.guid == there->guid(); });
  ASSERT_NE(participant, view.participants.end());
  EXPECT_EQ(participant->enclave, "/");
  EXPECT_EQ(vendor_name(vendor_of(participant->guid)), "Fast DDS");
  const auto find = [&](const Guid& guid) {
    const auto found = std::find_if(view.endpoints.begin(), view.endpoints.end(),
                                    [&](const auto& endpoint) { return endpoint.guid == guid; });
    return found == view.endpoints.end() ? DiscoveredEndpoint{} : *found;
  };
  EXPECT_EQ(find(writer.guid()).wire_topic, "rt/map");
  EXPECT_TRUE(find(writer.guid()).writes);
  EXPECT_TRUE(find(writer.guid()).transient_local);
  EXPECT_EQ(find(reader.guid()).wire_type, "nav_msgs::msg::dds_::OccupancyGrid_");
  EXPECT_FALSE(find(reader.guid()).writes);
  const std::string hash = convert::type_hash("nav_msgs/msg/OccupancyGrid");
  EXPECT_THAT(hash, ::testing::StartsWith("RIHS01_"));
  for (const Guid& guid : {reader.guid(), writer.guid()}) {
    EXPECT_EQ(find(guid).type_hash, hash);
    EXPECT_EQ(hash_seen_from(*there, guid), hash);
  }
  // Cyclone's ros2 tools print an error for an endpoint of the graph without one.
  const Node node(there, "/", "node");
  const GraphReader graph(here);
  ASSERT_TRUE(graph.wait_for_node("/node", seconds(20)));
  int graph_endpoints = 0;
  for (const DiscoveredEndpoint& endpoint : here->view().endpoints) {
    if (endpoint.wire_topic != "ros_discovery_info") continue;
    ++graph_endpoints;
    EXPECT_EQ(endpoint.type_hash, convert::type_hash("rmw_dds_common/msg/ParticipantEntitiesInfo"));
  }
  EXPECT_EQ(graph_endpoints, 2) << "its writer and our reader";
  EXPECT_TRUE(same_participant(reader.guid(), here->guid()));
  EXPECT_TRUE(writer.is_matched_with(here->guid()));
  EXPECT_FALSE(writer.is_matched_with(there->guid()));
}

}  // namespace
}  // namespace strata::bus
