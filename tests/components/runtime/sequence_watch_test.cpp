// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/sequence_watch.hpp"

#include <gtest/gtest.h>

namespace strata::runtime {
namespace {

bus::SampleIdentity from(std::uint8_t writer, std::int64_t number) {
  bus::SampleIdentity identity;
  identity.writer[0] = writer;
  identity.sequence_number = number;
  return identity;
}

TEST(SequenceWatch, CountsWhatIsMissingBetweenTheMessagesOfEachWriter) {
  SequenceWatch watch;
  EXPECT_EQ(watch.take(from(1, 100)), 0U) << "what was before it is none of ours";
  EXPECT_EQ(watch.take(from(1, 101)), 0U);
  EXPECT_EQ(watch.take(from(2, 7)), 0U);
  EXPECT_EQ(watch.take(from(1, 105)), 3U);
  EXPECT_EQ(watch.take(from(2, 9)), 1U);
  EXPECT_EQ(watch.missing(), 4U);
}

TEST(SequenceWatch, CountsNothingForMessagesThatComeAgainOrLate) {
  SequenceWatch watch;
  watch.take(from(1, 5));
  EXPECT_EQ(watch.take(from(1, 5)), 0U);
  EXPECT_EQ(watch.take(from(1, 4)), 0U);
  EXPECT_EQ(watch.missing(), 0U);
}

TEST(SequenceWatch, CannotTellWithoutAWriter) {
  SequenceWatch watch;
  watch.take(from(0, 1));
  EXPECT_EQ(watch.take(from(0, 9)), 0U);
}

TEST(SequenceWatch, ForgetsTheOldestOfManyWriters) {
  SequenceWatch watch;
  for (std::uint8_t writer = 1; writer <= 65; ++writer) watch.take(from(writer, 1));
  EXPECT_EQ(watch.take(from(65, 3)), 1U);
  EXPECT_EQ(watch.take(from(1, 9)), 0U);
}

}  // namespace
}  // namespace strata::runtime
