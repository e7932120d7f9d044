// SPDX-License-Identifier: Apache-2.0
/// The coordinator against a component of the test's own, whose answers it withholds.
#include "components/runtime/lockstep_coordinator.hpp"

#include <atomic>

#include <gtest/gtest.h>

#include "components/runtime/component.hpp"
#include "core/base/error.hpp"
#include "tests/components/bus/domain.hpp"

namespace strata::runtime {
namespace {

using strata_msgs::msg::Ack;
using strata_msgs::msg::Step;

/// Answers every step but the first ones.
class Forgetful {
 public:
  Forgetful(const std::shared_ptr<bus::Participant>& participant, int lost)
      : lost_(lost),
        acks_(participant, kAckTopic, bus::qos_profile("lossless")),
        steps_(participant, kStepTopic, bus::qos_profile("lossless"),
               [this](const Step& step) { answer(step); }) {}

  [[nodiscard]] int hellos() const { return hellos_; }
  [[nodiscard]] int cycles() const { return cycles_; }

 private:
  void answer(const Step& step) {
    if (step.kind() == strata_msgs::msg::STEP_HELLO) ++hellos_;
    if (step.kind() == strata_msgs::msg::STEP_CYCLE) ++cycles_;
    if (lost_-- > 0) return;
    Ack ack;
    ack.sequence_number(step.sequence_number());
    ack.component_name(step.target());
    ack.ok(true);
    acks_.publish(ack);
  }

  std::atomic<int> lost_;
  std::atomic<int> hellos_ = 0;
  std::atomic<int> cycles_ = 0;
  bus::Writer<Ack> acks_;
  bus::Reader<Step> steps_;  // last: its callback uses the others
};

// The answer to a first step is lost when the component's writer does not know the coordinator's
// reader yet; the replay would wait for it for ever.
TEST(LockstepCoordinator, GreetsAgainAComponentWhoseFirstAnswerWasLost) {
  const auto participant = test::make_participant();
  const Forgetful component(participant, 2);
  LockstepCoordinator coordinator(participant, {"/forgetful"},
                                  [](const std::string&, double) { return true; });
  coordinator.connect();
  EXPECT_GE(component.hellos(), 3);
  coordinator.cycle();
  coordinator.cycle();
  EXPECT_EQ(component.cycles(), 2) << "work is asked for once";
}

TEST(LockstepCoordinator, LeavesOutWhatIsNoAnswer) {
  const auto participant = test::make_participant();
  const Forgetful component(participant, 0);
  LockstepCoordinator coordinator(participant, {"/forgetful"},
                                  [](const std::string&, double) { return true; });
  bus::RawWriter broken(participant, kAckTopic, "strata_msgs/msg/Ack",
                        bus::qos_profile("lossless"));
  ASSERT_TRUE(broken.wait_for_readers(1, std::chrono::seconds(20)));
  coordinator.connect();
  broken.publish({0, 1, 0, 0, 1});
  broken.publish({0, 7, 0, 0});
  coordinator.cycle();
  EXPECT_EQ(component.cycles(), 1);
}

TEST(LockstepCoordinator, NamesWhoDoesNotAnswerAndEndsAWaitWhenItIsToldTo) {
  const auto participant = test::make_participant();
  const Forgetful component(participant, 1'000'000);
  std::string waited_for;
  double longest_s = 0.0;
  LockstepCoordinator coordinator(participant, {"/forgetful"},
                                  [&](const std::string& what, double waited_s) {
                                    waited_for = what;
                                    longest_s = waited_s;
                                    return component.hellos() < 2;
                                  });
  EXPECT_THROW(coordinator.connect(), Cancelled);
  EXPECT_EQ(waited_for, "/forgetful");
  EXPECT_GE(longest_s, 0.5) << "it was asked a second time";
}

}  // namespace
}  // namespace strata::runtime
