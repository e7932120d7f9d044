// SPDX-License-Identifier: Apache-2.0
/// Stamps that the messages of ROS 2 cannot carry are told, not wrapped.
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/log/bag.hpp"
#include "tests/components/player/drive.hpp"
#include "tests/components/runtime/host_fixture.hpp"
#include "tests/support/comes_true.hpp"
#include "tests/support/test_data.hpp"

namespace strata::player {
namespace {

constexpr std::int64_t kEndNs = (std::int64_t{1} << 31U) * 1'000'000'000;

TEST(PlayerStamps, BeyondThoseOfRos2AreTold) {
  for (const std::int64_t end : {kEndNs, -kEndNs}) {
    const test::TemporaryDirectory folder;
    {
      log::BagWriter bag(folder.path() / "bag", log::BagStorage::kSqlite3);
      const std::size_t topic = bag.add_topic({"/strange", "strange_msgs/msg/Thing", "cdr", ""});
      for (int i = 0; i < 2; ++i) {
        bag.write(topic, Stamp{end - 1 + i}, std::vector<std::uint8_t>{0, 1, 0, 0, 42, 0, 0, 0});
      }
      bag.close();
    }
    const auto participant = test::make_participant();
    test::Collector<rosgraph_msgs::msg::Clock> clocks(participant, "/clock", "default");
    const auto host = test::play(folder.path() / "bag", ", mode: messages, rate: 1", participant);
    ASSERT_TRUE(clocks.wait_for_writer());
    host->activate();
    std::vector<std::string> told;
    EXPECT_TRUE(test::comes_true([&] {
      for (std::string& error : host->take_errors()) told.push_back(std::move(error));
      return !told.empty();
    }));
    ASSERT_EQ(told.size(), 1U);
    EXPECT_THAT(told[0], testing::HasSubstr(": a message of /strange: its stamp "));
    EXPECT_THAT(told[0], testing::HasSubstr("does not fit into the messages of ROS 2"));
    // Of two messages that the end parts the one on this side has gone out.
    const std::size_t count = end > 0 ? 1 : 0;
    EXPECT_EQ(clocks.wait_for(count).size(), count);
  }
}

}  // namespace
}  // namespace strata::player
