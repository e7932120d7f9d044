// SPDX-License-Identifier: Apache-2.0
/// Components that wait for somebody to lead them through their lives, as nav2's lifecycle manager
/// does.
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

namespace strata::runtime {
namespace {

using std::chrono::seconds;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

struct DoorConfig {
  int width_cm = 90;
  bool jams = false;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("width_cm", c.width_cm, {.doc = "how wide it is", .min = 1.0, .max = 200.0});
    v.field("jams", c.jams, {.doc = "cannot be configured"});
    v.renamed("breadth_cm", "width_cm");
  }
};

/// Tells its width, as a clock, each time it becomes active.
class Door final : public Component {
 public:
  using Component::Component;

 private:
  void on_declare() override { declare_parameters<DoorConfig>(); }
  void on_configure() override {
    const auto config = read_parameters<DoorConfig>();
    width_cm_ = config.width_cm;
    publish_ = advertise<rosgraph_msgs::msg::Clock>("width", "latched");
    if (config.jams) throw InputError("the door", "jams", "oil it");
  }
  void on_activate() override {
    rosgraph_msgs::msg::Clock message;
    message.clock().sec(width_cm_);
    publish_(message);
  }
  int width_cm_ = 0;
  std::function<void(const rosgraph_msgs::msg::Clock&)> publish_;
};

/// As a component of a library that knows nothing of declaring.
class Mute final : public Component {
 public:
  using Component::Component;

 private:
  void on_configure() override { (void)read_parameters<DoorConfig>(); }
};

class Managed : public testing::Test {
 protected:
  Managed() {
    registry_.add<Door>("test::Door");
    registry_.add<Mute>("test::Mute");
  }
  void start(const std::string& more = "start: unconfigured", const std::string& type = "Door") {
    host_ = test::make_host("{type: test::" + type + ", name: door, " + more + "}", registry_,
                            test::make_participant());
    host_->activate();
  }
  template <typename S>
  [[nodiscard]] typename bus::ServiceType<S>::Response call(
      const std::string& service, const typename bus::ServiceType<S>::Request& request = {}) {
    const auto response = bus::call_service<S>(manager_, "/door/" + service, request, seconds(20));
    EXPECT_TRUE(response.has_value()) << service;
    return response.value_or(typename bus::ServiceType<S>::Response());
  }
  /// As the manager does: the transition, then the state that it has led to.
  [[nodiscard]] std::string lead(std::uint8_t id) {
    lifecycle_msgs::srv::ChangeState_Request request;
    request.transition().id(id);
    const bool success = call<bus::srv::ChangeState>("change_state", request).success();
    return (success ? "" : "refused: ") + state();
  }
  [[nodiscard]] std::string state() {
    return call<bus::srv::GetState>("get_state").current_state().label();
  }
  [[nodiscard]] rcl_interfaces::msg::SetParametersResult set(
      const std::string& name, rcl_interfaces::msg::ParameterValue value) {
    rcl_interfaces::srv::SetParameters_Request request;
    request.parameters().resize(1);
    request.parameters()[0].name(name);
    request.parameters()[0].value(std::move(value));
    const auto response = call<bus::srv::SetParameters>("set_parameters", request);
    return response.results().empty() ? rcl_interfaces::msg::SetParametersResult()
                                      : response.results()[0];
  }

  Registry registry_;
  std::shared_ptr<bus::Participant> manager_ = test::make_participant();
  std::unique_ptr<Host> host_;
};

TEST_F(Managed, GoThroughTheirLivesAsOftenAsTheyAreLed) {
  test::Collector<rosgraph_msgs::msg::Clock> widths(manager_, "/width", "latched");
  start();
  EXPECT_EQ(state(), "unconfigured");
  for (int life = 1; life <= 3; ++life) {
    EXPECT_EQ(lead(1), "inactive");
    EXPECT_EQ(lead(3), "active");
    EXPECT_EQ(widths.wait_for(2 * life - 1).size(), 2U * life - 1);
    EXPECT_EQ(lead(4), "inactive");  // the manager's pause
    EXPECT_EQ(lead(3), "active");    // and resume
    EXPECT_EQ(widths.wait_for(2 * life).size(), 2U * life);
    EXPECT_EQ(lead(4), "inactive");
    EXPECT_EQ(lead(2), "unconfigured");
  }
  EXPECT_EQ(lead(5), "finalized");
  EXPECT_EQ(lead(1), "refused: finalized");
  EXPECT_TRUE(host_->take_errors().empty());
}

TEST_F(Managed, KnowTheOldNamesOfTheirParametersAndWarn) {
  start("start: unconfigured, parameters: {breadth_cm: 70}");
  EXPECT_THAT(host_->take_errors(),
              ElementsAre(HasSubstr("breadth_cm is called width_cm now; the next version")));
  rcl_interfaces::srv::GetParameters_Request request;
  request.names({"width_cm", "breadth_cm"});
  const auto values = call<bus::srv::GetParameters>("get_parameters", request).values();
  ASSERT_EQ(values.size(), 2U);
  EXPECT_EQ(values[0].integer_value(), 70);
  EXPECT_EQ(values[1].integer_value(), 70);
  EXPECT_THAT(set("breadth_cm", parameter_value(std::int64_t{80})).reason(),
              HasSubstr("breadth_cm is called width_cm now"));
  EXPECT_EQ(lead(1), "inactive");
  EXPECT_EQ(call<bus::srv::GetParameters>("get_parameters", request).values()[0].integer_value(),
            80);
  EXPECT_TRUE(host_->take_errors().empty()) << "told once";
}

TEST_F(Managed, AreShutDownFromEveryState) {
  const std::vector<std::vector<std::uint8_t>> ways = {{5}, {1, 6}, {1, 3, 7}};
  for (const auto& way : ways) {
    start();
    std::string reached;
    for (const std::uint8_t id : way) reached = lead(id);
    EXPECT_EQ(reached, "finalized") << way.size() << " transitions";
  }
}

TEST_F(Managed, StayInactiveWhenTheCompositionSaysSo) {
  start("start: inactive");
  EXPECT_EQ(state(), "inactive");
  EXPECT_EQ(lead(3), "active");
}

TEST_F(Managed, HaveTheirParametersBeforeTheyAreConfigured) {
  test::Collector<rosgraph_msgs::msg::Clock> widths(manager_, "/width", "latched");
  start("start: unconfigured, parameters: {width_cm: 80, use_sim_time: false}");
  EXPECT_THAT(call<bus::srv::ListParameters>("list_parameters").result().names(),
              ElementsAre("width_cm", "jams", "use_sim_time"));
  EXPECT_FALSE(set("width_cm", parameter_value(std::int64_t{300})).successful());
  EXPECT_TRUE(set("width_cm", parameter_value(std::int64_t{70})).successful());
  ASSERT_EQ(lead(1), "inactive");
  ASSERT_EQ(lead(3), "active");
  EXPECT_EQ(widths.wait_for(1).at(0).clock().sec(), 70);
}

TEST_F(Managed, ThatDeclareNothingTakeParametersOnceTheyAreConfigured) {
  start("start: unconfigured", "Mute");
  EXPECT_THAT(call<bus::srv::ListParameters>("list_parameters").result().names(),
              ElementsAre("use_sim_time"));
  const auto early = set("width_cm", parameter_value(std::int64_t{70}));
  EXPECT_FALSE(early.successful());
  EXPECT_THAT(early.reason(), HasSubstr("has not been configured yet"));
  ASSERT_EQ(lead(1), "inactive");
  EXPECT_TRUE(set("width_cm", parameter_value(std::int64_t{70})).successful());
}

TEST_F(Managed, ThatCannotBeConfiguredSaySoAndMayBeMended) {
  start("start: unconfigured, parameters: {jams: true}");
  EXPECT_EQ(lead(1), "refused: unconfigured");
  EXPECT_THAT(host_->take_errors(), ElementsAre(HasSubstr("jams")));
  ASSERT_TRUE(set("jams", parameter_value(false)).successful());
  EXPECT_EQ(lead(1), "inactive");
}

TEST_F(Managed, RefuseAParameterThatConfigureWouldRefuseAndSayWhy) {
  start("start: active");
  const auto refused = set("jams", parameter_value(true));
  EXPECT_FALSE(refused.successful());
  EXPECT_THAT(refused.reason(), HasSubstr("jams; oil it"));
  EXPECT_EQ(state(), "active");
  EXPECT_TRUE(host_->take_errors().empty()) << "nothing has happened to the node itself";
  // What was refused is not there the next time.
  EXPECT_EQ(lead(4), "inactive");
  EXPECT_EQ(lead(2), "unconfigured");
  EXPECT_EQ(lead(1), "inactive");
}

TEST_F(Managed, TakeOneParameterWhileAnotherIsStillWrong) {
  start("start: unconfigured, parameters: {jams: true}");
  const auto other = set("width_cm", parameter_value(std::int64_t{70}));
  EXPECT_TRUE(other.successful());
  EXPECT_THAT(other.reason(), HasSubstr("fails as before: the door: jams"));
  EXPECT_TRUE(set("jams", parameter_value(false)).successful());
  EXPECT_EQ(lead(1), "inactive");
}

TEST_F(Managed, WithAParameterThatIsNotValidDoNotStartAtAll) {
  try {
    start("start: unconfigured, parameters: {widht_cm: 80}");
    FAIL() << "it started";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("did you mean 'width_cm'"));
  }
}

}  // namespace
}  // namespace strata::runtime
