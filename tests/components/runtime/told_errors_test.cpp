// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/told_errors.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace strata::runtime {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Optional;

const ToldErrors::Clock::time_point kBegin{};

TEST(ToldErrors, SaysTheFirstInWordsAndThenHowManyThereWere) {
  ToldErrors told;
  EXPECT_THAT(told.take("/scan: bad", kBegin), Optional(std::string("/scan: bad")));
  for (int i = 0; i < 999; ++i) EXPECT_EQ(told.take("/scan: bad", kBegin), std::nullopt);
  EXPECT_THAT(told.due(kBegin + ToldErrors::kPeriod - std::chrono::seconds(1)), IsEmpty());
  EXPECT_THAT(told.due(kBegin + ToldErrors::kPeriod), ElementsAre("/scan: bad (999 more in 30 s)"));
  EXPECT_THAT(told.due(kBegin + ToldErrors::kPeriod), IsEmpty());
}

TEST(ToldErrors, SaysOneThatComesAgainAfterAQuietTimeInWords) {
  ToldErrors told;
  (void)told.take("a", kBegin);
  EXPECT_THAT(told.due(kBegin + ToldErrors::kPeriod), IsEmpty());
  EXPECT_THAT(told.take("a", kBegin + ToldErrors::kPeriod), Optional(std::string("a")));
}

TEST(ToldErrors, IsNotFloodedByErrorsThatAreAllDifferent) {
  ToldErrors told;
  std::size_t lines = 0;
  for (int i = 0; i < 1000; ++i) {
    if (told.take("error " + std::to_string(i), kBegin)) ++lines;
  }
  EXPECT_EQ(lines, ToldErrors::kMaxKinds + 1);
  EXPECT_THAT(told.due(kBegin + ToldErrors::kPeriod), ElementsAre(HasSubstr("further kinds (984")));
}

TEST(OneLine, KeepsTextAndReplacesWhatWouldCommandATerminal) {
  EXPECT_EQ(one_line("frame 'größe' \xE2\x82\xAC"), "frame 'größe' \xE2\x82\xAC");
  EXPECT_EQ(one_line(std::string_view("a\0b\x1B[2J\nc\x7F", 10)), "a?b?[2J c?");
  EXPECT_EQ(one_line("\xC3(\xFF\xC0\xAF\xED\xA0\x80\xC2\x9B"), "?(????????");
  EXPECT_EQ(one_line("\xE2\x82"), "??");
}

TEST(OneLine, IsNeverLong) { EXPECT_LT(one_line(std::string(1'000'000, 'x')).size(), 1100U); }

}  // namespace
}  // namespace strata::runtime
