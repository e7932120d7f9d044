// SPDX-License-Identifier: Apache-2.0
/// What the hub sends to viewers.
#include "components/live_view/view_hub.hpp"

#include <string>

#include "tests/components/live_view/view_hub_fixture.hpp"

namespace strata::live_view {
namespace {

using Json = nlohmann::json;

TEST_F(ViewHubTest, SaysFirstWhoItIsThenWhatThereIs) {
  hub_.advertise("/scan", "sensor_msgs/msg/LaserScan", "float32 angle_min\n", false);
  const auto found = texts(joined());
  ASSERT_EQ(found.size(), 3U);
  EXPECT_EQ(found[0].at("op"), "serverInfo");
  EXPECT_EQ(found[0].at("supportedEncodings"), Json({"cdr"}));
  EXPECT_EQ(found[1].at("channels")[0], Json({{"id", 1},
                                              {"topic", "/scan"},
                                              {"encoding", "cdr"},
                                              {"schemaName", "sensor_msgs/msg/LaserScan"},
                                              {"schema", "float32 angle_min\n"},
                                              {"schemaEncoding", "ros2msg"}}));
  EXPECT_EQ(found[2].at("op"), "advertiseServices");
}

TEST_F(ViewHubTest, SendsAMessageAsTheProtocolSays) {
  const auto scan = hub_.advertise("/scan", "a/msg/B", "x", false);
  const ViewerId viewer = joined();
  (void)texts(viewer);
  subscribe(viewer, 0x01020304, scan);
  hub_.publish(scan, message(9));
  const auto frame = hub_.next(viewer);
  ASSERT_TRUE(frame.has_value());
  EXPECT_TRUE(frame->is_binary);
  EXPECT_EQ(frame->head, (std::vector<std::uint8_t>{1, 4, 3, 2, 1, 7, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(frame->message->cdr, (std::vector<std::uint8_t>{0, 1, 0, 0, 9}));
}

TEST_F(ViewHubTest, KeepsTheNewestOfEachWriterForAViewerThatDoesNotRead) {
  const auto scan = hub_.advertise("/scan", "a/msg/B", "x", false);
  const ViewerId slow = joined();
  (void)texts(slow);
  subscribe(slow, 1, scan);
  const int woken_before = woken_;
  for (int i = 0; i < 200; ++i) {
    hub_.publish(scan, message(static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(i % 2)));
  }
  EXPECT_EQ(woken_, woken_before + 1) << "woken once until it has taken all";
  EXPECT_EQ(hub_.counts().waiting, 2U);
  EXPECT_EQ(hub_.counts().dropped, 198U);
  EXPECT_EQ(contents(slow), (std::vector<int>{198, 199}));
}

TEST_F(ViewHubTest, KeepsAtMost64WritersOfATopic) {
  const auto tf = hub_.advertise("/tf_static", "a/msg/B", "x", true);
  const ViewerId slow = joined();
  subscribe(slow, 1, tf);
  for (int i = 0; i < 100; ++i) {
    hub_.publish(tf, message(static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(i)));
  }
  EXPECT_EQ(hub_.counts().waiting, 64U);
  const ViewerId late = joined();
  subscribe(late, 1, tf);
  EXPECT_EQ(contents(late).size(), 64U);
}

TEST_F(ViewHubTest, GivesALateViewerTheLatchedMessagesOfEveryWriterAndNoOthers) {
  const auto map = hub_.advertise("/map", "a/msg/B", "x", true);
  const auto scan = hub_.advertise("/scan", "a/msg/B", "x", false);
  hub_.publish(map, message(1, 1));
  hub_.publish(map, message(2, 2));
  hub_.publish(map, message(3, 1));
  hub_.publish(scan, message(4));
  const ViewerId late = joined();
  subscribe(late, 1, map);
  subscribe(late, 2, scan);
  EXPECT_EQ(contents(late), (std::vector<int>{2, 3}));
}

TEST_F(ViewHubTest, ServesTopicsInTurn) {
  const auto first = hub_.advertise("/a", "a/msg/B", "x", false);
  const auto second = hub_.advertise("/b", "a/msg/B", "x", false);
  const ViewerId viewer = joined();
  (void)texts(viewer);
  subscribe(viewer, 1, first);
  subscribe(viewer, 2, second);
  for (std::uint8_t writer = 0; writer < 3; ++writer) hub_.publish(first, message(1, writer));
  hub_.publish(second, message(2));
  EXPECT_EQ(contents(viewer), (std::vector<int>{1, 2, 1, 1}));
}

TEST_F(ViewHubTest, StopsWhatIsUnsubscribedAndForgetsWhoLeaves) {
  const auto scan = hub_.advertise("/scan", "a/msg/B", "x", false);
  const ViewerId viewer = joined();
  subscribe(viewer, 1, scan);
  EXPECT_EQ(hub_.wanted(), std::vector<std::uint32_t>{scan});
  hub_.take(viewer, false, R"({"op":"unsubscribe","subscriptionIds":[1,99,-3,"x"]})");
  EXPECT_TRUE(hub_.wanted().empty());
  subscribe(viewer, 2, scan);
  hub_.leave(viewer);
  EXPECT_TRUE(hub_.wanted().empty());
  hub_.publish(scan, message(1));
  EXPECT_FALSE(hub_.next(viewer).has_value());
}

TEST_F(ViewHubTest, TakesATopicBackWithItsSubscriptions) {
  const auto gone = hub_.advertise("/gone", "std_msgs/msg/String", "string data", true);
  const auto stays = hub_.advertise("/stays", "std_msgs/msg/String", "string data", false);
  const ViewerId viewer = joined();
  subscribe(viewer, 1, gone);
  subscribe(viewer, 2, stays);
  (void)texts(viewer);
  hub_.withdraw(gone);
  const auto told = texts(viewer);
  ASSERT_EQ(told.size(), 1U);
  EXPECT_EQ(told[0], (nlohmann::json{{"op", "unadvertise"}, {"channelIds", {gone}}}));
  EXPECT_EQ(hub_.wanted(), std::vector<std::uint32_t>{stays});
  hub_.publish(gone, message(1));
  hub_.publish(stays, message(2));
  EXPECT_EQ(contents(viewer), std::vector<int>{2});
  subscribe(viewer, 3, gone);
  EXPECT_EQ(hub_.counts().refused, 1U);
  EXPECT_GT(hub_.advertise("/gone", "std_msgs/msg/String", "string data", true), stays)
      << "a number is used once";
}

TEST_F(ViewHubTest, KeepsWhatIsLatchedOfWritersThatAreAliveOrElseTheNewest) {
  const auto channel = hub_.advertise("/map", "std_msgs/msg/String", "string data", true);
  for (std::uint8_t writer = 1; writer <= 3; ++writer) {
    hub_.publish(channel, message(writer, writer));
  }
  hub_.keep_writers({message(0, 2)->writer});
  const ViewerId first = joined();
  subscribe(first, 1, channel);
  EXPECT_EQ(contents(first), std::vector<int>{2});
  hub_.publish(channel, message(4, 4));
  hub_.keep_writers({});
  const ViewerId second = joined();
  subscribe(second, 1, channel);
  EXPECT_EQ(contents(second), std::vector<int>{4});
}

TEST_F(ViewHubTest, RefusesMoreViewersThanItMayHave) {
  const ViewerId first = joined();
  (void)joined();
  EXPECT_FALSE(hub_.join([] {}).has_value());
  hub_.leave(first);
  EXPECT_TRUE(hub_.join([] {}).has_value());
}

}  // namespace
}  // namespace strata::live_view
