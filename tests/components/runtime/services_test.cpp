// SPDX-License-Identifier: Apache-2.0
/// A component managed from another participant by ROS 2's services.
#include <memory>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/bus/service.hpp"
#include "components/runtime/host.hpp"
#include "components/runtime/parameters.hpp"
#include "core/base/error.hpp"
#include "tests/components/runtime/host_fixture.hpp"

namespace strata::runtime {
namespace {

using std::chrono::seconds;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

struct MuteConfig {
  int answer = 42;
  bool loud = false;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("answer", c.answer, {.doc = "what is said when active", .min = 0.0, .max = 100.0});
    v.field("loud", c.loud, {});
  }
};

/// Publishes its answer, as a clock, each time it becomes active and, when loud, at each tick.
class Mute final : public Component {
 public:
  using Component::Component;

 private:
  void on_configure() override {
    config_ = read_parameters<MuteConfig>();
    keep_live(config_, {"loud"});
    publish_ = advertise<rosgraph_msgs::msg::Clock>("said", "latched");
  }
  void on_activate() override { say(); }
  void on_tick() override {
    if (config_.loud) say();
  }
  void say() {
    rosgraph_msgs::msg::Clock message;
    message.clock().sec(config_.answer);
    publish_(message);
  }
  MuteConfig config_;
  std::function<void(const rosgraph_msgs::msg::Clock&)> publish_;
};

class Services : public testing::Test {
 protected:
  Services() {
    Registry registry;
    registry.add<Mute>("strata::Mute");
    host_ = test::make_host("{type: strata::Mute, name: mute, namespace: /robot1}", registry,
                            test::make_participant());
  }
  template <typename S>
  [[nodiscard]] typename bus::ServiceType<S>::Response call(
      const std::string& service, const typename bus::ServiceType<S>::Request& request = {}) {
    const auto response =
        bus::call_service<S>(manager_, "/robot1/mute/" + service, request, seconds(20));
    EXPECT_TRUE(response.has_value()) << service;
    return response.value_or(typename bus::ServiceType<S>::Response());
  }
  [[nodiscard]] bool change_state(std::uint8_t id, const std::string& label = "") {
    lifecycle_msgs::srv::ChangeState_Request request;
    request.transition().id(id);
    request.transition().label(label);
    return call<bus::srv::ChangeState>("change_state", request).success();
  }
  [[nodiscard]] std::string state() {
    return call<bus::srv::GetState>("get_state").current_state().label();
  }
  template <typename T>
  [[nodiscard]] rcl_interfaces::msg::SetParametersResult set(const std::string& name,
                                                             const T& value) {
    rcl_interfaces::srv::SetParameters_Request request;
    request.parameters().resize(1);
    request.parameters()[0].name(name);
    request.parameters()[0].value(parameter_value(value));
    const auto response = call<bus::srv::SetParameters>("set_parameters", request);
    return response.results().empty() ? rcl_interfaces::msg::SetParametersResult()
                                      : response.results()[0];
  }
  [[nodiscard]] rcl_interfaces::msg::ParameterValue get(const std::string& name) {
    rcl_interfaces::srv::GetParameters_Request request;
    request.names({name});
    const auto response = call<bus::srv::GetParameters>("get_parameters", request);
    return response.values().empty() ? rcl_interfaces::msg::ParameterValue() : response.values()[0];
  }

  std::shared_ptr<bus::Participant> manager_ = test::make_participant();
  std::unique_ptr<Host> host_;
};

TEST_F(Services, LeadAComponentThroughItsLife) {
  test::Collector<lifecycle_msgs::msg::TransitionEvent> events(
      manager_, "/robot1/mute/transition_event", "default");
  EXPECT_EQ(state(), "inactive");
  EXPECT_TRUE(change_state(3));
  EXPECT_EQ(state(), "active");
  EXPECT_TRUE(change_state(0, "deactivate"));
  EXPECT_TRUE(change_state(2));
  EXPECT_EQ(state(), "unconfigured");
  EXPECT_TRUE(change_state(1));
  EXPECT_TRUE(change_state(3));
  EXPECT_EQ(state(), "active");
  const auto seen = events.wait_for(10);  // two of each
  ASSERT_GE(seen.size(), 10U);
  EXPECT_EQ(seen[8].transition().label(), "activate");
  EXPECT_EQ(seen[8].start_state().label(), "inactive");
  EXPECT_EQ(seen[9].goal_state().id(), 3);
}

TEST_F(Services, RefuseATransitionThatDoesNotStartHere) {
  EXPECT_FALSE(change_state(1));
  EXPECT_FALSE(change_state(4));
  EXPECT_FALSE(change_state(0, "fly"));
  EXPECT_EQ(state(), "inactive");
}

TEST_F(Services, TellWhereOneCanGoFromHere) {
  const auto response = call<bus::srv::GetAvailableTransitions>("get_available_transitions");
  std::vector<std::string> labels;
  for (const auto& entry : response.available_transitions()) {
    labels.push_back(entry.transition().label());
  }
  EXPECT_THAT(labels, ElementsAre("cleanup", "activate", "shutdown"));
  EXPECT_EQ(call<bus::srv::GetAvailableStates>("get_available_states").available_states().size(),
            11U);
}

TEST_F(Services, EndAComponentForGood) {
  EXPECT_TRUE(change_state(0, "shutdown"));
  EXPECT_EQ(state(), "finalized");
  EXPECT_FALSE(change_state(1));
}

TEST_F(Services, ListDescribeAndGetParameters) {
  const auto listed = call<bus::srv::ListParameters>("list_parameters");
  EXPECT_THAT(listed.result().names(), ElementsAre("answer", "loud", "use_sim_time"));
  EXPECT_EQ(get("answer").integer_value(), 42);
  EXPECT_EQ(get("nothing").type(), 0);
  rcl_interfaces::srv::DescribeParameters_Request request;
  request.names({"answer"});
  const auto described = call<bus::srv::DescribeParameters>("describe_parameters", request);
  ASSERT_EQ(described.descriptors().size(), 1U);
  EXPECT_EQ(described.descriptors()[0].description(),
            "what is said when active; an expert setting");
  EXPECT_EQ(described.descriptors()[0].integer_range()[0].to_value(), 100);
  rcl_interfaces::srv::GetParameterTypes_Request types;
  types.names({"loud", "answer"});
  EXPECT_THAT(call<bus::srv::GetParameterTypes>("get_parameter_types", types).types(),
              ElementsAre(1, 2));
}

TEST_F(Services, RefuseAParameterOutOfRange) {
  const auto result = set("answer", std::int64_t{101});
  EXPECT_FALSE(result.successful());
  EXPECT_THAT(result.reason(), HasSubstr("100"));
  EXPECT_EQ(get("answer").integer_value(), 42);
}

TEST_F(Services, ChangeAParameterThatTakesEffectAtTheNextConfigure) {
  test::Collector<rcl_interfaces::msg::ParameterEvent> events(manager_, "/parameter_events",
                                                              "parameters");
  test::Collector<rosgraph_msgs::msg::Clock> said(manager_, "/robot1/said", "latched");
  const auto result = set("answer", std::int64_t{43});
  EXPECT_TRUE(result.successful());
  EXPECT_THAT(result.reason(), HasSubstr("configured again"));
  EXPECT_EQ(get("answer").integer_value(), 43);
  const auto told = events.wait_for(1);
  ASSERT_FALSE(told.empty());
  EXPECT_EQ(told[0].node(), "/robot1/mute");
  EXPECT_EQ(told[0].changed_parameters()[0].name(), "answer");
  ASSERT_TRUE(change_state(3));
  EXPECT_EQ(said.wait_for(1).at(0).clock().sec(), 42);
  for (const std::uint8_t id : {4, 2, 1, 3}) ASSERT_TRUE(change_state(id));
  EXPECT_EQ(said.wait_for(2).at(1).clock().sec(), 43);
}

TEST_F(Services, ChangeALiveParameterWhileTheComponentIsActive) {
  ASSERT_TRUE(change_state(3));
  EXPECT_EQ(set("loud", true).reason(), "");
  test::Collector<rosgraph_msgs::msg::Clock> said(manager_, "/robot1/said", "latched");
  ASSERT_EQ(said.wait_for(1).size(), 1U);  // what it said when it became active
  host_->tick();
  EXPECT_GE(said.wait_for(2).size(), 2U);
}

TEST_F(Services, ChangeAllOrNone) {
  rcl_interfaces::srv::SetParametersAtomically_Request request;
  request.parameters().resize(2);
  request.parameters()[0].name("answer");
  request.parameters()[0].value(parameter_value(std::int64_t{1}));
  request.parameters()[1].name("loud");
  request.parameters()[1].value(parameter_value(std::string("yes")));
  EXPECT_FALSE(call<bus::srv::SetParametersAtomically>("set_parameters_atomically", request)
                   .result()
                   .successful());
  EXPECT_EQ(get("answer").integer_value(), 42);
}

TEST_F(Services, SetUseSimTime) {
  EXPECT_FALSE(get("use_sim_time").bool_value());
  EXPECT_TRUE(set("use_sim_time", true).successful());
  EXPECT_TRUE(get("use_sim_time").bool_value());
}

}  // namespace
}  // namespace strata::runtime
