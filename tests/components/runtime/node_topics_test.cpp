// SPDX-License-Identifier: Apache-2.0
/// What a component tells of itself on the topics that every managed node of ROS 2 has, and that a
/// composition may give them other names.
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/bus/service.hpp"
#include "components/runtime/host.hpp"
#include "components/runtime/parameters.hpp"
#include "core/base/error.hpp"
#include "tests/components/runtime/host_fixture.hpp"
#include "tests/support/comes_true.hpp"

namespace strata::runtime {
namespace {

using lifecycle_msgs::msg::TransitionEvent;
using rcl_interfaces::msg::ParameterEvent;
using std::chrono::seconds;
using ::testing::ElementsAre;

struct GateConfig {
  double width_m = 1.0;
  bool jams = false;
  bool sticks = false;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("width_m", c.width_m, {.doc = "how wide it is", .min = 0.5, .max = 9.0});
    v.field("jams", c.jams, {.doc = "cannot be configured"});
    v.field("sticks", c.sticks, {.doc = "cannot be activated"});
    v.renamed("breadth_m", "width_m");
  }
};

class Gate final : public Component {
 public:
  using Component::Component;
  [[nodiscard]] Stamp time() const { return now(); }

 private:
  void on_declare() override { declare_parameters<GateConfig>(); }
  void on_configure() override {
    config_ = read_parameters<GateConfig>();
    keep_live(config_, {"width_m", "jams", "sticks"});
    if (config_.jams) throw InputError("the gate", "jams", "oil it");
  }
  void on_activate() override {
    if (config_.sticks) throw InputError("the gate", "sticks", "push it");
  }
  GateConfig config_;
};

class NodeTopics : public testing::Test {
 protected:
  void start(const std::string& more) {
    Registry registry;
    registry.add<Gate>("test::Gate");
    host_ = test::make_host("{type: test::Gate, name: gate, namespace: /yard, " + more + "}",
                            registry, test::make_participant());
    host_->activate();
    // Readers are met in the order in which they were made: where an answer comes back, the
    // component has met the collectors before it.
    ASSERT_TRUE(
        bus::call_service<bus::srv::GetState>(manager_, "/yard/gate/get_state", {}, seconds(20))
            .has_value());
  }
  [[nodiscard]] bool lead(std::uint8_t id) {
    lifecycle_msgs::srv::ChangeState_Request request;
    request.transition().id(id);
    const auto response = bus::call_service<bus::srv::ChangeState>(
        manager_, "/yard/gate/change_state", request, seconds(20));
    return response && response->success();
  }
  [[nodiscard]] bool set(std::vector<rcl_interfaces::msg::Parameter> parameters) {
    rcl_interfaces::srv::SetParametersAtomically_Request request;
    request.parameters(std::move(parameters));
    const auto response = bus::call_service<bus::srv::SetParametersAtomically>(
        manager_, "/yard/gate/set_parameters_atomically", request, seconds(20));
    return response && response->result().successful();
  }
  std::shared_ptr<bus::Participant> manager_ = test::make_participant();
  std::unique_ptr<Host> host_;
};

std::vector<std::string> lines_of(const std::vector<TransitionEvent>& events) {
  std::vector<std::string> lines;
  for (const TransitionEvent& event : events) {
    lines.push_back(std::to_string(event.start_state().id()) + " " + event.start_state().label() +
                    " > " + std::to_string(event.goal_state().id()) + " " +
                    event.goal_state().label() + " by " + std::to_string(event.transition().id()) +
                    " " + event.transition().label());
  }
  return lines;
}

TEST_F(NodeTopics, TellEachTransitionInTheTwoStepsOfRos2) {
  test::Collector<TransitionEvent> events(manager_, "/yard/gate/transition_event", "default");
  start("start: unconfigured");
  ASSERT_TRUE(events.wait_for_writer());
  for (const std::uint8_t id : {1, 3, 4, 2, 5}) ASSERT_TRUE(lead(id));
  EXPECT_THAT(lines_of(events.wait_for(10)),
              ElementsAre("1 unconfigured > 10 configuring by 1 configure",
                          "10 configuring > 2 inactive by 10 transition_success",
                          "2 inactive > 13 activating by 3 activate",
                          "13 activating > 3 active by 30 transition_success",
                          "3 active > 14 deactivating by 4 deactivate",
                          "14 deactivating > 2 inactive by 40 transition_success",
                          "2 inactive > 11 cleaningup by 2 cleanup",
                          "11 cleaningup > 1 unconfigured by 20 transition_success",
                          "1 unconfigured > 12 shuttingdown by 5 shutdown",
                          "12 shuttingdown > 4 finalized by 50 transition_success"));
}

TEST_F(NodeTopics, TellOfTransitionsThatFail) {
  test::Collector<TransitionEvent> events(manager_, "/yard/gate/transition_event", "default");
  start("start: unconfigured, parameters: {jams: true, sticks: true}");
  ASSERT_TRUE(events.wait_for_writer());
  EXPECT_FALSE(lead(1));
  ASSERT_TRUE(set({parameter("jams", parameter_value(false))}));
  EXPECT_TRUE(lead(1));
  EXPECT_FALSE(lead(3));
  EXPECT_FALSE(lead(4)) << "does not start here, so nothing is told";
  EXPECT_TRUE(lead(6));
  EXPECT_THAT(lines_of(events.wait_for(8)),
              ElementsAre("1 unconfigured > 10 configuring by 1 configure",
                          "10 configuring > 1 unconfigured by 11 transition_failure",
                          "1 unconfigured > 10 configuring by 1 configure",
                          "10 configuring > 2 inactive by 10 transition_success",
                          "2 inactive > 13 activating by 3 activate",
                          "13 activating > 2 inactive by 31 transition_failure",
                          "2 inactive > 12 shuttingdown by 6 shutdown",
                          "12 shuttingdown > 4 finalized by 50 transition_success"));
}

TEST_F(NodeTopics, TellParametersAsTheyAreSetUnderTheirPresentNames) {
  test::Collector<ParameterEvent> events(manager_, "/parameter_events", "parameters");
  start("start: active");
  ASSERT_TRUE(events.wait_for_writer());
  ASSERT_TRUE(set({parameter("breadth_m", parameter_value(std::int64_t{2})),
                   parameter("jams", parameter_value(true)),
                   parameter("use_sim_time", parameter_value(true))}));
  const auto told = events.wait_for(1);
  ASSERT_EQ(told.size(), 1U);
  const auto& changed = told[0].changed_parameters();
  ASSERT_EQ(changed.size(), 3U);
  EXPECT_EQ(changed[0].name(), "width_m");
  EXPECT_EQ(changed[0].value(), parameter_value(2.0)) << "a double, whatever was asked for";
  EXPECT_EQ(changed[1], parameter("jams", parameter_value(true)));
  EXPECT_EQ(changed[2], parameter("use_sim_time", parameter_value(true)));
}

TEST_F(NodeTopics, HaveTheNamesThatTheCompositionGivesThem) {
  test::Collector<ParameterEvent> events(manager_, "/yard/parameter_events", "parameters");
  test::Collector<TransitionEvent> transitions(manager_, "/yard/steps", "default");
  test::Collector<rcl_interfaces::msg::Log> log(manager_, "/yard/log", "rosout");
  bus::Writer<rosgraph_msgs::msg::Clock> clock(manager_, "/simulation/clock",
                                               bus::qos_profile("clock"));
  start(
      "start: inactive, parameters: {use_sim_time: true}, remappings: {/clock: /simulation/clock, "
      "/rosout: log, /parameter_events: parameter_events, /diagnostics: health, "
      "~/transition_event: steps}");
  ASSERT_TRUE(events.wait_for_writer());
  ASSERT_TRUE(transitions.wait_for_writer());
  ASSERT_TRUE(clock.raw().wait_for_readers(1, seconds(20)));
  rosgraph_msgs::msg::Clock message;
  message.clock().sec(77);
  const auto& gate = dynamic_cast<const Gate&>(*host_->components()[0]);
  EXPECT_TRUE(test::comes_true([&] {
    clock.publish(message);
    return gate.time() == Stamp{77'000'000'000};
  }));
  EXPECT_TRUE(lead(3));
  EXPECT_TRUE(set({parameter("width_m", parameter_value(3.0))}));
  EXPECT_FALSE(transitions.wait_for(1).empty());
  EXPECT_FALSE(events.wait_for(1).empty());
  EXPECT_FALSE(log.wait_for(1).empty());
}

}  // namespace
}  // namespace strata::runtime
