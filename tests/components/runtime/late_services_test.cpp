// SPDX-License-Identifier: Apache-2.0
/// Services whose answer comes later, or not at all, and live parameters that cannot be done.
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/bus/bag_service_types.hpp"
#include "components/bus/service.hpp"
#include "components/runtime/host.hpp"
#include "components/runtime/parameters.hpp"
#include "core/base/error.hpp"
#include "tests/components/runtime/host_fixture.hpp"
#include "tests/support/comes_true.hpp"

namespace strata::runtime {
namespace {

using std::chrono::seconds;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

using Answer = std::function<void(const rosbag2_interfaces::srv::PlayNext_Response&)>;

struct SlowConfig {
  int level = 1;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("level", c.level, {});
  }
};

/// Its services keep what they are to answer with, and fail; its level cannot be 13.
class Slow final : public Component {
 public:
  using Component::Component;
  [[nodiscard]] std::vector<Answer> kept() const {
    const std::lock_guard lock(mutex_);
    return kept_;
  }

 private:
  void on_configure() override {
    (void)read_parameters<SlowConfig>();
    keep_live<SlowConfig>({"level"}, [](const SlowConfig& config) {
      if (config.level == 13) throw OutputError("level", "is too much now", "try again");
    });
    offer_later<bus::srv::PlayNext>("~/play_next", [this](const auto&, auto reply) {
      const std::lock_guard lock(mutex_);
      kept_.push_back(std::move(reply));
    });
    offer_later<bus::srv::Resume>("~/resume", [](const auto&, const auto&) {
      throw OutputError("the lamp", "is broken", "change it");
    });
  }
  mutable std::mutex mutex_;
  std::vector<Answer> kept_;
};

class LateServices : public testing::Test {
 protected:
  LateServices() {
    Registry registry;
    registry.add<Slow>("test::Slow");
    host_ = test::make_host("{type: test::Slow, name: slow}", registry, test::make_participant());
    host_->activate();
  }
  [[nodiscard]] Slow& slow() { return dynamic_cast<Slow&>(*host_->components().front()); }
  /// Asks and does not wait for the answer.
  template <typename S>
  [[nodiscard]] std::unique_ptr<bus::RawWriter> ask(const std::string& service) {
    auto request = std::make_unique<bus::RawWriter>(
        client_, bus::TopicName("/slow/" + service, bus::TopicKind::kRequest),
        std::string(bus::ServiceType<S>::name) + "_Request", bus::qos_profile("default"));
    EXPECT_TRUE(request->wait_for_readers(1, seconds(20)));
    request->publish(convert::to_cdr(typename bus::ServiceType<S>::Request()));
    return request;
  }
  [[nodiscard]] std::string state() {
    const auto response =
        bus::call_service<bus::srv::GetState>(client_, "/slow/get_state", {}, seconds(20));
    return response ? response->current_state().label() : "no answer";
  }

  std::shared_ptr<bus::Participant> client_ = test::make_participant();
  std::unique_ptr<Host> host_;
};

TEST_F(LateServices, TellWhatTheyCouldNotDoAndGoOn) {
  const auto request = ask<bus::srv::Resume>("resume");
  std::vector<std::string> told;
  EXPECT_TRUE(test::comes_true([&] { return !(told = host_->take_errors()).empty(); }));
  EXPECT_THAT(told, ElementsAre(HasSubstr("/slow: the lamp: is broken; change it")));
  EXPECT_EQ(state(), "active");
}

TEST_F(LateServices, AnswerNobodyOnceTheComponentIsCleanedUp) {
  const auto request = ask<bus::srv::PlayNext>("play_next");
  ASSERT_TRUE(test::comes_true([&] { return slow().kept().size() == 1; }));
  slow().deactivate();
  slow().cleanup();
  slow().kept().front()({});  // the server is gone
  EXPECT_EQ(state(), "unconfigured");
  slow().configure();
  slow().activate();
  slow().kept().front()({});  // the one that is there now has not been asked
  const auto again = ask<bus::srv::PlayNext>("play_next");
  EXPECT_TRUE(test::comes_true([&] { return slow().kept().size() == 2; }));
  EXPECT_EQ(state(), "active");
  EXPECT_THAT(host_->take_errors(), testing::IsEmpty());
}

TEST_F(LateServices, LeaveAnswersToBeCalledWhenTheComponentIsGone) {
  const auto request = ask<bus::srv::PlayNext>("play_next");
  ASSERT_TRUE(test::comes_true([&] { return slow().kept().size() == 1; }));
  const std::vector<Answer> kept = slow().kept();
  host_.reset();
  EXPECT_NO_THROW(kept.front()({}));
}

TEST_F(LateServices, SetALiveParameterAndSayThatItCouldNotBeDone) {
  rcl_interfaces::srv::SetParameters_Request request;
  request.parameters({parameter("level", parameter_value(std::int64_t{13}))});
  const auto response = bus::call_service<bus::srv::SetParameters>(client_, "/slow/set_parameters",
                                                                   request, seconds(20));
  ASSERT_TRUE(response.has_value());
  ASSERT_EQ(response->results().size(), 1U);
  EXPECT_THAT(response->results()[0].reason(), HasSubstr("is too much now; try again"));
  EXPECT_EQ(state(), "active");
}

}  // namespace
}  // namespace strata::runtime
