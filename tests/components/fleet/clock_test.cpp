// SPDX-License-Identifier: Apache-2.0
#include "components/fleet/clock.hpp"

#include <chrono>
#include <set>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/fleet/push.hpp"
#include "tests/components/fleet/fleet_fixture.hpp"

namespace strata::fleet {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

std::int64_t now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

class FleetClock : public test::FleetFixture {};

TEST_F(FleetClock, IsComparedWithTheServersByOneQuestion) {
  Connection robot = as("hall.r1");
  const ClockOffset right = clock_offset(robot);
  EXPECT_LE(std::abs(right.ahead_s), right.within_s + 1e-3) << "one machine has one clock";
  EXPECT_THAT(right.warning(), IsEmpty());
  const ClockOffset ahead = clock_offset(robot, [] { return now_ns() + 46'000'000'000; });
  EXPECT_NEAR(ahead.ahead_s, 46.0, ahead.within_s + 1e-3);
  EXPECT_THAT(ahead.warning(), HasSubstr("46.0 s ahead of"));
  const ClockOffset behind = clock_offset(robot, [] { return now_ns() - 5'000'000'000; });
  EXPECT_THAT(behind.warning(), HasSubstr("5.0 s behind"));
  int asked = 0;
  const ClockOffset slow = clock_offset(robot, [&] { return now_ns() + 4'000'000'000 * asked++; });
  EXPECT_NEAR(slow.ahead_s, 2.0, 0.5) << "the middle of question and answer";
  EXPECT_NEAR(slow.within_s, 2.0, 0.5);
}

TEST(ClockOffset, IsNotOffWhereTheAnswerTookTooLongToTell) {
  EXPECT_TRUE((ClockOffset{3.0, 0.5}).is_off());
  EXPECT_TRUE((ClockOffset{-3.0, 0.5}).is_off());
  EXPECT_FALSE((ClockOffset{3.0, 1.5}).is_off());
  EXPECT_FALSE((ClockOffset{1.5, 0.0}).is_off());
}

TEST_F(FleetClock, ThatIsAheadShowsInVisitsFromTheFuture) {
  (void)release_first_tour("hall");
  const std::int64_t now_s = now_ns() / 1'000'000'000;
  const auto push_as = [&](const std::string& robot, std::int64_t begin_s) {
    test::write_maps(at(robot), {test::first_tour(), test::drive(begin_s, 1)});
    Connection connection = as("hall." + robot);
    push(connection, "hall", at(robot), [](const PushedVisit&) {});
  };
  push_as("r1", now_s - 100'000);
  push_as("r2", now_s + 100'000);
  Connection ada = as("hall.ada");
  const auto ahead = visits_ahead(ada, "hall", {});
  ASSERT_THAT(ahead, SizeIs(1));
  EXPECT_EQ(ahead[0].name.robot, "r2");
  EXPECT_EQ(ahead[0].name.number / 1'000'000'000, now_s + 100'000);
  EXPECT_NEAR(ahead[0].ahead_s, 100'000.0, 60.0);
  EXPECT_THAT(visits_ahead(ada, "hall", {ahead[0].name.sha256}), IsEmpty()) << "it is learned";
  EXPECT_THAT(visits_ahead(ada, "yard", {}), IsEmpty());
}

}  // namespace
}  // namespace strata::fleet
