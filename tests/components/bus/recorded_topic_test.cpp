// SPDX-License-Identifier: Apache-2.0
/// What who records makes of a message.
#include "components/bus/recorded_topic.hpp"

#include <gtest/gtest.h>

namespace strata::bus {
namespace {

constexpr Stamp kNow{1'764'000'000'000'000'000};
constexpr Duration span_s(double value) { return {static_cast<std::int64_t>(value * 1e9)}; }

TEST(StampToRecord, IsTheWritersOwnOfWhatHasJustBeenWritten) {
  for (const bool is_latched : {false, true}) {
    for (const Stamp written : {kNow, kNow - span_s(0.3), kNow + span_s(0.3)}) {
      EXPECT_EQ(stamp_to_record(written, is_latched, kNow), written);
    }
  }
}

TEST(StampToRecord, OfWhatIsLatchedAndOldIsWhenItCame) {
  EXPECT_EQ(stamp_to_record(kNow - span_s(3600.0), true, kNow), kNow);
  EXPECT_EQ(stamp_to_record(kNow - span_s(2.0), true, kNow), kNow);
  EXPECT_EQ(stamp_to_record(kNow - span_s(2.0), false, kNow), kNow - span_s(2.0))
      << "it waited for a slow disk";
}

TEST(StampToRecord, OfAWriterWithoutAClockIsWhenTheMessageCame) {
  constexpr Stamp kIn1970{1'000'000'000};
  constexpr Stamp kNone{-1};
  for (const Stamp written : {kIn1970, kNone, kNow + span_s(3600.0)}) {
    EXPECT_EQ(stamp_to_record(written, false, kNow), kNow);
  }
}

}  // namespace
}  // namespace strata::bus
