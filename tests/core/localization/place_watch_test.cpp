// SPDX-License-Identifier: Apache-2.0
#include "core/localization/place_watch.hpp"

#include <gtest/gtest.h>

namespace strata::localization {
namespace {

using Step = PlaceWatch::Step;

constexpr PlaceWatchConfig kConfig{
    .doubted_score = 0.3, .doubted_scans = 4, .trusted_score = 0.6, .max_scans = 6};

/// Of so many scans of that score, the one with that step; 0 for none.
int scans_until(Step step, PlaceWatch& watch, double score, int scans) {
  for (int n = 1; n <= scans; ++n) {
    if (watch.judge(score) == step) return n;
  }
  return 0;
}

TEST(PlaceWatch, BeginsASearchAfterScansOnEndThatSpeakAgainstThePose) {
  PlaceWatch watch(kConfig);
  EXPECT_EQ(scans_until(Step::kBegin, watch, 0.2, 3), 0);
  EXPECT_EQ(watch.judge(0.4), Step::kNone);  // not on end
  EXPECT_EQ(scans_until(Step::kBegin, watch, 0.2, 10), 4);
  EXPECT_TRUE(watch.is_searching());
}

TEST(PlaceWatch, LeavesAPoseBeThatFitsSomewhat) {
  PlaceWatch watch(kConfig);
  EXPECT_EQ(scans_until(Step::kBegin, watch, 0.3, 100), 0);
  PlaceWatchConfig off = kConfig;
  off.is_used = false;
  PlaceWatch blind(off);
  EXPECT_EQ(scans_until(Step::kBegin, blind, 0.0, 100), 0);
}

TEST(PlaceWatch, EndsTheSearchWhenThePoseIsTrustedAgain) {
  PlaceWatch watch(kConfig);
  ASSERT_EQ(scans_until(Step::kBegin, watch, 0.0, 10), 4);
  EXPECT_EQ(watch.judge(0.59), Step::kNone);
  EXPECT_EQ(watch.judge(0.6), Step::kEnd);
  EXPECT_FALSE(watch.is_searching());
  EXPECT_EQ(scans_until(Step::kBegin, watch, 0.0, 10), 4) << "it does not rest";
}

TEST(PlaceWatch, RestsLongerAfterEachSearchInVain) {
  PlaceWatch watch(kConfig);
  for (const int rest : {0, 6, 12, 24}) {
    EXPECT_EQ(scans_until(Step::kBegin, watch, 0.0, 100), rest + 4);
    EXPECT_EQ(scans_until(Step::kEnd, watch, 0.0, 100), 6);
  }
  EXPECT_EQ(watch.judge(0.7), Step::kNone);
  EXPECT_EQ(scans_until(Step::kBegin, watch, 0.0, 100), 4) << "nothing is in vain any more";
}

TEST(PlaceWatch, KnowsWhetherThePoseWasEverBelievedSinceTheStart) {
  PlaceWatch watch(kConfig);
  EXPECT_EQ(watch.judge(0.2), Step::kNone);
  EXPECT_FALSE(watch.was_believed()) << "somebody told it, and no scan said so";
  EXPECT_EQ(watch.judge(0.3), Step::kNone);
  EXPECT_TRUE(watch.was_believed());
  EXPECT_EQ(scans_until(Step::kBegin, watch, 0.2, 3), 0);
  EXPECT_EQ(watch.judge(0.2), Step::kBegin);
  EXPECT_TRUE(watch.was_believed()) << "it was, whatever scans say now";
  watch.forget();
  EXPECT_FALSE(watch.was_believed());
  ASSERT_EQ(scans_until(Step::kBegin, watch, 0.2, 10), 4);
  EXPECT_EQ(watch.judge(0.4), Step::kNone);
  EXPECT_FALSE(watch.was_believed()) << "it is still looked for elsewhere";
  EXPECT_EQ(watch.judge(0.6), Step::kEnd);
  EXPECT_TRUE(watch.was_believed());
  watch.forget();
  watch.believe();
  EXPECT_TRUE(watch.was_believed());
}

TEST(PlaceWatch, DoesNotBelieveAPoseWhileItRestsFromASearchInVain) {
  PlaceWatch watch(kConfig);
  ASSERT_EQ(scans_until(Step::kBegin, watch, 0.0, 10), 4);
  ASSERT_EQ(scans_until(Step::kEnd, watch, 0.0, 10), 6);
  EXPECT_EQ(scans_until(Step::kBegin, watch, 0.5, 6), 0);
  EXPECT_FALSE(watch.was_believed());
  EXPECT_EQ(watch.judge(0.5), Step::kNone);
  EXPECT_TRUE(watch.was_believed());
}

}  // namespace
}  // namespace strata::localization
