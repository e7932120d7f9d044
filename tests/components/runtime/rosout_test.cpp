// SPDX-License-Identifier: Apache-2.0
/// What a node says on /rosout, and what ROS 2's graph shows of it.
#include "components/runtime/rosout.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/bus/service.hpp"
#include "components/convert/type_hash.hpp"
#include "components/runtime/host.hpp"
#include "core/base/error.hpp"
#include "tests/components/runtime/host_fixture.hpp"

namespace strata::runtime {
namespace {

using rcl_interfaces::msg::Log;
using std::chrono::seconds;
using ::testing::ElementsAre;

std::vector<std::string> texts(const std::vector<Log>& logs) {
  std::vector<std::string> result;
  for (const Log& log : logs) result.push_back(log.msg());
  return result;
}

TEST(Rosout, GivesLateReadersTheLastMessagesUnderTheNodesName) {
  const auto here = test::make_participant();
  Rosout rosout(here, "/robot1/localizer");
  rosout.log(LogLevel::kInfo, "first", Stamp{1'500'000'000});
  rosout.log(LogLevel::kError, "second", Stamp{2'000'000'000});
  test::Collector<Log> late(test::make_participant(), "/rosout", "rosout");
  const auto logs = late.wait_for(2);
  ASSERT_EQ(logs.size(), 2U);
  EXPECT_EQ(logs[0].name(), "robot1.localizer");
  EXPECT_EQ(logs[0].level(), 20);
  EXPECT_EQ(logs[0].stamp().sec(), 1);
  EXPECT_EQ(logs[0].stamp().nanosec(), 500'000'000U);
  EXPECT_EQ(logs[1].level(), 40);
  EXPECT_EQ(logs[1].msg(), "second");
}

TEST(Rosout, WarnsOnceOfWhatLasts) {
  const auto here = test::make_participant();
  Rosout rosout(here, "/n");
  Health lasting;
  lasting.warn("no mounting");
  lasting.fail("told as an error");
  Health more = lasting;
  more.warn("no odometry");
  rosout.warn(lasting, "told as an error", {});
  rosout.warn(more, "told as an error", {});
  rosout.warn(more, "told as an error", {});
  rosout.warn(Health(), "", {});
  rosout.warn(lasting, "told as an error", {});
  test::Collector<Log> late(test::make_participant(), "/rosout", "rosout");
  EXPECT_THAT(texts(late.wait_for(3)), ElementsAre("no mounting", "no odometry", "no mounting"));
}

struct NoConfig {
  template <class Self, class V>
  static void describe(Self& /*c*/, V& /*v*/) {}
};

/// Warns always, and cannot stand clocks.
class Grumbler final : public Component {
 public:
  using Component::Component;

 private:
  void on_configure() override {
    (void)read_parameters<NoConfig>();
    subscribe<rosgraph_msgs::msg::Clock>("times", "default", [](const auto&) {
      throw InputError("times", "cannot be told", "send none");
    });
  }
  void on_diagnose(Health& health) const override { health.warn("it is cold"); }
};

class NodeOfRos2 : public testing::Test {
 protected:
  NodeOfRos2() {
    Registry registry;
    registry.add<Grumbler>("strata::Grumbler");
    host_ = test::make_host(
        "{type: strata::Grumbler, name: grumbler, namespace: /robot1, parameters: {use_sim_time: "
        "true}}",
        registry, node_);
  }
  /// The endpoints of the topic that the node tells of as its own.
  [[nodiscard]] std::vector<bus::DiscoveredEndpoint> own_endpoints(const std::string& wire_topic) {
    const bus::GraphReader graph(tool_);
    EXPECT_TRUE(graph.wait_for_node("/robot1/grumbler", seconds(20)));
    std::vector<bus::DiscoveredEndpoint> result;
    for (const auto& [participant, nodes] : graph.nodes()) {
      for (const bus::NodeInfo& node : nodes) {
        for (const bus::DiscoveredEndpoint& endpoint : node_->view().endpoints) {
          const auto& guids = endpoint.writes ? node.writers : node.readers;
          const bool is_own = std::find(guids.begin(), guids.end(), endpoint.guid) != guids.end();
          if (is_own && endpoint.wire_topic == wire_topic) result.push_back(endpoint);
        }
      }
    }
    return result;
  }

  std::shared_ptr<bus::Participant> node_ = test::make_participant();
  std::shared_ptr<bus::Participant> tool_ = test::make_participant();
  std::unique_ptr<Host> host_;
};

TEST_F(NodeOfRos2, LogsItsLifeItsErrorsAndItsWarnings) {
  test::Collector<Log> logs(tool_, "/rosout", "rosout");
  bus::Writer<rosgraph_msgs::msg::Clock> times(tool_, "/robot1/times", bus::qos_profile("default"));
  host_->activate();
  ASSERT_TRUE(times.raw().wait_for_readers(1, seconds(20)));
  times.publish({});
  const std::vector<Log> seen = logs.wait_for(4);
  const auto has = [&](int level, const std::string& text) {
    return std::any_of(seen.begin(), seen.end(), [&](const Log& log) {
      return log.level() == level && log.msg().find(text) != std::string::npos &&
             log.name() == "robot1.grumbler";
    });
  };
  EXPECT_TRUE(has(20, "configure: is inactive now"));
  EXPECT_TRUE(has(20, "activate: is active now"));
  EXPECT_TRUE(has(40, "cannot be told; send none"));
  EXPECT_TRUE(has(30, "it is cold"));
}

TEST_F(NodeOfRos2, OwnsItsLogItsClockAndItsServices) {
  const auto rosout = own_endpoints("rt/rosout");
  ASSERT_EQ(rosout.size(), 1U);
  EXPECT_TRUE(rosout[0].writes);
  EXPECT_TRUE(rosout[0].reliable);
  EXPECT_TRUE(rosout[0].transient_local);
  EXPECT_EQ(rosout[0].type_hash, convert::type_hash("rcl_interfaces/msg/Log"));
  const auto clock = own_endpoints("rt/clock");
  ASSERT_EQ(clock.size(), 1U);
  EXPECT_FALSE(clock[0].writes);
  EXPECT_EQ(own_endpoints("rq/robot1/grumbler/get_type_descriptionRequest").size(), 1U);
}

TEST_F(NodeOfRos2, DescribesTypesToOthers) {
  type_description_interfaces::srv::GetTypeDescription_Request request;
  request.type_name("rosgraph_msgs/msg/Clock");
  request.type_hash(convert::type_hash("rosgraph_msgs/msg/Clock"));
  const auto response = bus::call_service<bus::srv::GetTypeDescription>(
      tool_, "/robot1/grumbler/get_type_description", request, seconds(20));
  ASSERT_TRUE(response.has_value());
  EXPECT_TRUE(response->successful());
  EXPECT_EQ(response->type_description().type_description().fields().at(0).name(), "clock");
}

}  // namespace
}  // namespace strata::runtime
