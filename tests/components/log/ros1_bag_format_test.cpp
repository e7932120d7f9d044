// SPDX-License-Identifier: Apache-2.0
/// A bag of ROS 1 whose bytes were counted out by hand.
#include <string>

#include "strata_idl/std_msgs.h"
#include <gtest/gtest.h>

#include "components/convert/cdr.hpp"
#include "tests/components/log/log_fixture.hpp"
#include "tests/components/log/ros1_bag_maker.hpp"

namespace strata::log {
namespace {

using test_log::Ros1BagMaker;
using test_log::write_text;

std::string repeated(char c, std::size_t times) { return std::string(times, c); }
template <std::size_t size>
std::string text(const char (&bytes)[size]) {
  return {bytes, size - 1};
}

/// A connection's record, which stands in the chunk and at the end.
std::string chat_connection() {
  return text(
      "\x24\x00\x00\x00"
      "\x04\x00\x00\x00op=\x07"
      "\x09\x00\x00\x00"
      "conn=\x00\x00\x00\x00"
      "\x0B\x00\x00\x00topic=/chat"
      "\x79\x00\x00\x00"
      "\x0B\x00\x00\x00topic=/chat"
      "\x14\x00\x00\x00type=std_msgs/String"
      "\x27\x00\x00\x00md5sum=992ce8a1687cec8c8bd883ec73ca41d1"
      "\x23\x00\x00\x00message_definition=# not looked at\n");
}

/// Counted out by hand from http://wiki.ros.org/Bags/Format/2.0: one message of three letters.
std::string chat_bag() {
  return "#ROSBAG V2.0\n" +
         text(
             "\x45\x00\x00\x00"
             "\x04\x00\x00\x00op=\x03"
             "\x12\x00\x00\x00index_pos=\x63\x11\x00\x00\x00\x00\x00\x00"
             "\x0F\x00\x00\x00"
             "conn_count=\x01\x00\x00\x00"
             "\x10\x00\x00\x00"
             "chunk_count=\x01\x00\x00\x00"
             "\xBB\x0F\x00\x00") +
         repeated(' ', 4027) +
         text(
             "\x29\x00\x00\x00"
             "\x04\x00\x00\x00op=\x05"
             "\x10\x00\x00\x00"
             "compression=none"
             "\x09\x00\x00\x00size=\xDA\x00\x00\x00"
             "\xDA\x00\x00\x00") +
         chat_connection() +
         text(
             "\x26\x00\x00\x00"
             "\x04\x00\x00\x00op=\x02"
             "\x09\x00\x00\x00"
             "conn=\x00\x00\x00\x00"
             "\x0D\x00\x00\x00time=\x05\x00\x00\x00\x07\x00\x00\x00"
             "\x07\x00\x00\x00\x03\x00\x00\x00hi!") +
         text(
             "\x2F\x00\x00\x00"
             "\x04\x00\x00\x00op=\x04"
             "\x08\x00\x00\x00ver=\x01\x00\x00\x00"
             "\x09\x00\x00\x00"
             "conn=\x00\x00\x00\x00"
             "\x0A\x00\x00\x00"
             "count=\x01\x00\x00\x00"
             "\x0C\x00\x00\x00\x05\x00\x00\x00\x07\x00\x00\x00\xA5\x00\x00\x00") +
         chat_connection() +
         text(
             "\x64\x00\x00\x00"
             "\x04\x00\x00\x00op=\x06"
             "\x08\x00\x00\x00ver=\x01\x00\x00\x00"
             "\x12\x00\x00\x00"
             "chunk_pos=\x15\x10\x00\x00\x00\x00\x00\x00"
             "\x13\x00\x00\x00start_time=\x05\x00\x00\x00\x07\x00\x00\x00"
             "\x11\x00\x00\x00"
             "end_time=\x05\x00\x00\x00\x07\x00\x00\x00"
             "\x0A\x00\x00\x00"
             "count=\x01\x00\x00\x00"
             "\x08\x00\x00\x00\x00\x00\x00\x00\x01\x00\x00\x00");
}

TEST(Ros1BagFormat, IsReadFromTheBytesOfThePublishedFormat) {
  const strata::test::TemporaryDirectory folder;
  write_text(folder.path() / "drive.bag", chat_bag());
  const auto bag = test_log::read_bag(folder.path() / "drive.bag");
  EXPECT_EQ(bag.damage.count, 0U) << bag.damage.first;
  ASSERT_EQ(bag.topics.size(), 1U);
  EXPECT_EQ(bag.topics[0].name, "/chat");
  EXPECT_EQ(bag.topics[0].type, "std_msgs/msg/String");
  EXPECT_EQ(bag.topics[0].serialization_format, "cdr");
  ASSERT_EQ(bag.messages.size(), 1U);
  EXPECT_EQ(bag.messages[0].first, 5'000'000'007);
  std_msgs::msg::String message;
  message.data("hi!");
  EXPECT_EQ(bag.messages[0].second, convert::to_cdr(message));
}

// All other tests go by the maker.
TEST(Ros1BagFormat, OfTheMakerHasTheBytesOfThePublishedFormat) {
  Ros1BagMaker maker;
  maker.write(test_log::kRos1Chat, {5'000'000'007}, test_log::Ros1Bytes().text("hi!").bytes());
  EXPECT_EQ(maker.finish(), chat_bag());
}

}  // namespace
}  // namespace strata::log
