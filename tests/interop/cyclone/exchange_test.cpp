// SPDX-License-Identifier: Apache-2.0
/// Our wire against another maker's DDS: Cyclone reads every type into structs that its own IDL
/// compiler made, and writes them back.
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/bus/node.hpp"
#include "components/bus/text_message.hpp"
#include "tests/components/bus/domain.hpp"
#include "tests/components/runtime/host_fixture.hpp"
#include "tests/interop/cyclone/process.hpp"
#include "tests/interop/cyclone/samples.hpp"

namespace strata::test {
namespace {

template <typename T>
std::string type_of() {
  const std::string name = bus::MessageType<T>::name;
  return name.substr(name.rfind('/') + 1);
}

/// One type there and back, in the order in which a robot might start.
class Exchange {
 public:
  virtual ~Exchange() = default;
  virtual void start(const std::shared_ptr<bus::Participant>& participant) = 0;
  virtual void expect_answer() = 0;
};

template <typename T>
class TypedExchange final : public Exchange {
 public:
  explicit TypedExchange(T message) : message_(std::move(message)) {}
  void start(const std::shared_ptr<bus::Participant>& participant) override {
    answers_ = std::make_unique<Collector<T>>(participant, "/answer_" + type_of<T>(), "latched");
    writer_ = std::make_unique<bus::Writer<T>>(participant, "/ask_" + type_of<T>(),
                                               bus::qos_profile("latched"));
    writer_->publish(message_);
  }
  void expect_answer() override {
    const std::vector<T> answers = answers_->wait_for(1);
    ASSERT_FALSE(answers.empty()) << type_of<T>();
    EXPECT_EQ(answers[0], message_) << type_of<T>();
  }

 private:
  T message_;
  std::unique_ptr<Collector<T>> answers_;
  std::unique_ptr<bus::Writer<T>> writer_;
};

template <typename... T>
std::vector<std::unique_ptr<Exchange>> exchanges() {
  std::vector<std::unique_ptr<Exchange>> result;
  (result.push_back(std::make_unique<TypedExchange<T>>(sample<T>())), ...);
  return result;
}

/// Every type that Strata reads or writes.
std::vector<std::unique_ptr<Exchange>> all_exchanges() {
  using namespace strata_msgs::msg;  // NOLINT: the list is long enough
  return exchanges<
      diagnostic_msgs::msg::DiagnosticArray, geometry_msgs::msg::PoseWithCovarianceStamped,
      lifecycle_msgs::msg::TransitionEvent, nav2_msgs::msg::CostmapFilterInfo,
      nav2_msgs::msg::ParticleCloud, nav_msgs::msg::OccupancyGrid, nav_msgs::msg::Odometry,
      octomap_msgs::msg::Octomap, rcl_interfaces::msg::Log, rcl_interfaces::msg::ParameterEvent,
      rosgraph_msgs::msg::Clock, sensor_msgs::msg::LaserScan, sensor_msgs::msg::PointCloud2,
      sensor_msgs::msg::Image, sensor_msgs::msg::CameraInfo, tf2_msgs::msg::TFMessage, Ack,
      LabeledScan, LocalizationHealth, NodeMap, PatchMap, ReflectionGrid, ScanPose, Step,
      SubmapStates, Topologies, Trajectory, geometry_msgs::msg::PointStamped, bond::msg::Status,
      std_msgs::msg::String>();
}

TEST(Cyclone, ReadsAndWritesEveryTypeAsWeDoWhenItIsThereFirst) {
  CycloneProcess cyclone({"echo"});
  ASSERT_EQ(cyclone.wait_for_line("ready"), "ready");
  const auto participant = make_participant();
  const auto all = all_exchanges();
  for (const auto& exchange : all) exchange->start(participant);
  for (const auto& exchange : all) exchange->expect_answer();
}

TEST(Cyclone, ReadsAndWritesEveryTypeAsWeDoWhenItComesLate) {
  const auto participant = make_participant();
  const auto all = all_exchanges();
  for (const auto& exchange : all) exchange->start(participant);
  CycloneProcess cyclone({"echo"});
  for (const auto& exchange : all) exchange->expect_answer();
}

TEST(Cyclone, GetsAMapOfFourMegabytesAndSendsItBackToALateJoiner) {
  CycloneProcess cyclone({"echo"});
  ASSERT_EQ(cyclone.wait_for_line("ready"), "ready");
  const nav_msgs::msg::OccupancyGrid map = square_map(2000);
  const auto participant = make_participant();
  bus::Writer<nav_msgs::msg::OccupancyGrid> writer(participant, "/ask_OccupancyGrid",
                                                   bus::qos_profile("latched"));
  writer.publish(map);
  ASSERT_EQ(cyclone.wait_for_line("echoed OccupancyGrid"), "echoed OccupancyGrid");
  // Cyclone wrote its answer before anybody listened.
  Collector<nav_msgs::msg::OccupancyGrid> late(make_participant(), "/answer_OccupancyGrid",
                                               "latched");
  const auto answers = late.wait_for(1);
  ASSERT_EQ(answers.size(), 1U);
  EXPECT_TRUE(answers[0] == map);
}

/// Best effort may lose what is sent, so it is sent until an answer comes.
TEST(Cyclone, ExchangesWithBestEffortOnBothSides) {
  const auto participant = make_participant();
  Collector<sensor_msgs::msg::LaserScan> answers(participant, "/answer_best_effort", "sensor_data");
  bus::Writer<sensor_msgs::msg::LaserScan> writer(participant, "/ask_best_effort",
                                                  bus::qos_profile("sensor_data"));
  CycloneProcess cyclone({"best_effort"});
  ASSERT_EQ(cyclone.wait_for_line("ready"), "ready");
  ASSERT_TRUE(writer.raw().wait_for_readers(1, std::chrono::seconds(20)));
  const auto message = sample<sensor_msgs::msg::LaserScan>();
  std::vector<sensor_msgs::msg::LaserScan> got;
  for (int i = 0; got.empty() && i < 100; ++i) {
    writer.publish(message);
    got = answers.wait_for(1, std::chrono::milliseconds(200));
  }
  ASSERT_FALSE(got.empty());
  EXPECT_EQ(got[0], message);
}

/// The graph's message has Gids of another length in another release of ROS 2.
class CycloneGraph : public testing::TestWithParam<std::pair<const char*, const char*>> {
 protected:
  static std::shared_ptr<bus::Participant> make_participant_of_the_release() {
    bus::ParticipantOptions options;
    options.domain = own_domain();
    options.transport = bus::Transport::kLoopback;
    options.ros_distro = GetParam().first;
    return std::make_shared<bus::Participant>(options);
  }
  static std::string gid_bytes() { return GetParam().second; }
};

TEST_P(CycloneGraph, ShowsOurNodesToCyclone) {
  const auto participant = make_participant_of_the_release();
  const bus::Node first(participant, "/robot1", "localizer");
  CycloneProcess cyclone({"nodes", gid_bytes()});
  EXPECT_EQ(cyclone.wait_for_line("node /robot1 localizer"), "node /robot1 localizer");
  const bus::Node second(participant, "/", "map_server");
  EXPECT_EQ(cyclone.wait_for_line("node / map_server"), "node / map_server");
}

TEST_P(CycloneGraph, ShowsUsTheNodesOfCyclone) {
  CycloneProcess cyclone({"announce", gid_bytes(), "/robot2", "planner"});
  ASSERT_EQ(cyclone.wait_for_line("ready"), "ready");
  const bus::GraphReader graph(make_participant_of_the_release());
  ASSERT_TRUE(graph.wait_for_node("/robot2/planner", std::chrono::seconds(20)));
  const auto all = graph.nodes();
  ASSERT_EQ(all.size(), 1U);
  const auto& [participant, nodes] = *all.begin();
  ASSERT_EQ(nodes.size(), 1U);
  EXPECT_EQ(nodes[0].node_namespace, "/robot2");
  EXPECT_EQ(nodes[0].name, "planner");
  ASSERT_EQ(nodes[0].readers.size(), 1U);
  ASSERT_EQ(nodes[0].writers.size(), 2U);
  bus::Guid expected = participant;
  expected.back() = 1;
  EXPECT_EQ(nodes[0].readers[0], expected);
  EXPECT_EQ(nodes[0].writers[0], expected);
  expected.back() = 2;
  EXPECT_EQ(nodes[0].writers[1], expected);
}

INSTANTIATE_TEST_SUITE_P(Releases, CycloneGraph,
                         testing::Values(std::pair("humble", "24"), std::pair("jazzy", "16")),
                         [](const auto& each) { return std::string(each.param.first); });

}  // namespace
}  // namespace strata::test
