// SPDX-License-Identifier: Apache-2.0
/// A player under the control of others, by the services of rosbag2's player and by parameters.
#include "tests/components/player/player_services.hpp"

#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace strata::player {
namespace {

using runtime::parameter_value;

TEST_P(PlayerServices, PlayNextStepByStepWhilePausedAndTheRestWhenResumed) {
  start(", paused: true, rate: 0.001");
  EXPECT_TRUE(is_paused());
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(play_next()) << i;
  EXPECT_EQ(played(3), first(3));
  resume();
  EXPECT_FALSE(is_paused());
  EXPECT_FALSE(play_next()) << "it plays by itself, if slowly";
  EXPECT_TRUE(set_rate(1e6));
  EXPECT_EQ(played(kScans), first(kScans));
  call<bus::srv::TogglePaused>("toggle_paused");
  EXPECT_TRUE(is_paused());
  EXPECT_FALSE(play_next()) << "nothing is left";
}

TEST_P(PlayerServices, PauseInTheMiddleOfALog) {
  start(", loop: true, rate: 1000");
  ASSERT_GE(played(5).size(), 5U);
  pause();
  const std::vector<int> before = played(5);  // delivered while they are written
  EXPECT_TRUE(is_paused());
  EXPECT_TRUE(play_next());
  EXPECT_TRUE(play_next());
  const std::vector<int> after = played(before.size() + 2);
  ASSERT_EQ(after.size(), before.size() + 2) << "nothing was played between pause and play_next";
  for (std::size_t i = 0; i < after.size(); ++i) {
    EXPECT_EQ(after[i], static_cast<int>(i % kScans)) << i;
  }
}

TEST_P(PlayerServices, SeekAPlaceByItsStamp) {
  start(", paused: true");
  EXPECT_TRUE(seek(17.5));
  EXPECT_TRUE(play_next());
  EXPECT_EQ(played(1).back(), 17);
  EXPECT_TRUE(seek(3.0));
  EXPECT_TRUE(play_next());
  EXPECT_EQ(played(2).back(), 2);
  EXPECT_FALSE(seek(kScans + 0.5)) << "behind the end";
  EXPECT_TRUE(play_next());
  EXPECT_EQ(played(3).back(), 3) << "goes on where it was";
  EXPECT_TRUE(seek(0.25)) << "before the beginning";
  EXPECT_TRUE(play_next());
  EXPECT_EQ(played(4).back(), 0);
  EXPECT_TRUE(is_paused());
}

TEST_P(PlayerServices, SeekBackFromTheEnd) {
  start(", start_s: 18, rate: 1000000");
  EXPECT_EQ(played(2), (std::vector<int>{18, 19}));
  EXPECT_TRUE(seek(18.0));
  EXPECT_EQ(played(5), (std::vector<int>{18, 19, 17, 18, 19}));
}

TEST_P(PlayerServices, SeekInTheMiddleOfPlaying) {
  start(", rate: 0.001");
  EXPECT_EQ(played(1), first(1));
  EXPECT_TRUE(seek(18.0));  // 17 minutes away
  EXPECT_EQ(played(2), (std::vector<int>{0, 17}));
  EXPECT_TRUE(seek(3.0));
  EXPECT_EQ(played(3), (std::vector<int>{0, 17, 2}));
  EXPECT_TRUE(seek(18.5));
  EXPECT_TRUE(set_rate(1e6));
  EXPECT_EQ(played(5), (std::vector<int>{0, 17, 2, 18, 19})) << "and nothing of before";
  EXPECT_FALSE(is_paused());
}

TEST_P(PlayerServices, SetTheRateAtOnce) {
  start(", rate: 0.001");
  EXPECT_EQ(played(1).size(), 1U);
  EXPECT_EQ(rate(), 0.001);
  for (const double wrong : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(),
                             std::numeric_limits<double>::infinity()}) {
    EXPECT_FALSE(set_rate(wrong)) << wrong;
    EXPECT_EQ(rate(), 0.001);
  }
  EXPECT_TRUE(set_rate(1e6));  // would otherwise play for five hours
  EXPECT_EQ(played(kScans), first(kScans));
  EXPECT_EQ(rate(), 1e6);
}

TEST_P(PlayerServices, AgreeWithTheParameters) {
  start(", rate: 0.001, paused: true");
  EXPECT_TRUE(set_rate(0.002));
  EXPECT_EQ(parameter("rate").double_value(), 0.002);
  resume();
  EXPECT_FALSE(parameter("paused").bool_value());
  EXPECT_TRUE(set_parameter("paused", parameter_value(true)));
  EXPECT_TRUE(is_paused());
  EXPECT_FALSE(set_parameter("rate", parameter_value(0.0)));
  EXPECT_EQ(rate(), 0.002);
  EXPECT_TRUE(set_parameter("rate", parameter_value(1e6)));
  EXPECT_EQ(rate(), 1e6);
  EXPECT_TRUE(is_paused()) << "the rate is another, no more";
  EXPECT_TRUE(set_parameter("paused", parameter_value(false)));
  EXPECT_EQ(played(kScans), first(kScans));
}

INSTANTIATE_TEST_SUITE_P(All, PlayerServices, testing::Values("robot", "messages"));

}  // namespace
}  // namespace strata::player
