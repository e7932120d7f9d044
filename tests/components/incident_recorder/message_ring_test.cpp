// SPDX-License-Identifier: Apache-2.0
#include "components/incident_recorder/message_ring.hpp"

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace strata::incident_recorder {
namespace {

using std::chrono::seconds;
using ::testing::ElementsAre;
using ::testing::SizeIs;

const MessageRing::Clock::time_point kStart{seconds(1000)};

std::shared_ptr<const KeptTopic> topic(const std::string& name, bool is_latched) {
  return std::make_shared<const KeptTopic>(KeptTopic{name, "std_msgs/msg/String", "", is_latched});
}

/// Written as it comes, unless it is told when.
KeptMessagePtr message(const std::shared_ptr<const KeptTopic>& of, int at_s, std::uint8_t content,
                       std::uint8_t writer = 0, std::size_t bytes = 100) {
  KeptMessage kept{of, {}, Stamp{at_s * 1'000'000'000LL}, kStart + seconds(at_s), {}};
  kept.writer[0] = writer;
  kept.cdr.assign(bytes, content);
  return std::make_shared<const KeptMessage>(std::move(kept));
}

std::vector<int> contents(const MessageRing& ring) {
  std::vector<int> all;
  for (const KeptMessagePtr& kept : ring.messages()) all.push_back(kept->cdr.front());
  return all;
}

TEST(MessageRing, KeepsWhatCameWithinItsSpanInOrder) {
  const auto scans = topic("/scan", false);
  MessageRing ring(seconds(10), 1'000'000);
  for (int at_s = 0; at_s < 20; ++at_s) ring.add(message(scans, at_s, static_cast<uint8_t>(at_s)));
  ring.forget(kStart + seconds(19));
  EXPECT_THAT(contents(ring), ElementsAre(9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19));
  ring.forget(kStart + seconds(40));
  EXPECT_THAT(contents(ring), SizeIs(0));
  EXPECT_EQ(ring.bytes(), 0U);
  EXPECT_EQ(ring.gone_early(), 0U);
}

TEST(MessageRing, KeepsTheLastOfEachWriterOfALatchedTopicAndStampsItAtTheBeginning) {
  const auto maps = topic("/map", true);
  const auto scans = topic("/scan", false);
  MessageRing ring(seconds(10), 1'000'000);
  ring.add(message(maps, 0, 1, 1));
  ring.add(message(maps, 1, 2, 1));
  ring.add(message(maps, 2, 3, 2));
  ring.add(message(scans, 30, 4));
  ring.add(message(maps, 31, 5, 1));
  ring.forget(kStart + seconds(32));
  EXPECT_THAT(contents(ring), ElementsAre(2, 3, 4, 5));
  const auto all = ring.messages();
  EXPECT_EQ(all[0]->stamp.ns, 30'000'000'000LL) << "a player must not wait for half a minute";
  EXPECT_EQ(all[1]->stamp.ns, 30'000'000'000LL);
  EXPECT_EQ(all[3]->stamp.ns, 31'000'000'000LL);
}

TEST(MessageRing, StaysWithinItsMemoryAndCountsWhatHadToGo) {
  const auto scans = topic("/scan", false);
  MessageRing ring(seconds(1000), 50'000);
  for (int at_s = 0; at_s < 200; ++at_s) {
    ring.add(message(scans, at_s, static_cast<std::uint8_t>(at_s), 0, 1000));
    ASSERT_LE(ring.bytes(), 50'000U);
  }
  const std::vector<int> left = contents(ring);
  EXPECT_GT(left.size(), 40U);
  EXPECT_EQ(left.back(), 199);
  EXPECT_EQ(ring.gone_early(), 200 - left.size());
}

TEST(MessageRing, OfLatchedWritersWithoutEndStaysWithinItsMemory) {
  const auto maps = topic("/map", true);
  MessageRing ring(seconds(1), 50'000);
  for (int at_s = 0; at_s < 200; ++at_s) {
    ring.add(message(maps, at_s, 1, static_cast<std::uint8_t>(at_s), 1000));
    ring.forget(kStart + seconds(at_s + 2));
    ASSERT_LE(ring.bytes(), 50'000U);
  }
  EXPECT_GT(contents(ring).size(), 40U);
}

}  // namespace
}  // namespace strata::incident_recorder
