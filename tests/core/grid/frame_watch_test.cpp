// SPDX-License-Identifier: Apache-2.0
#include "core/grid/frame_watch.hpp"

#include <gtest/gtest.h>

namespace strata {
namespace {

using Verdict = FrameWatch::Verdict;

/// After `places` looks, 1 m from each other.
Verdict after(FrameWatch& watch, int places, const FrameLook& look) {
  Verdict verdict = Verdict::kOpen;
  for (int i = 0; i < places; ++i) verdict = watch.add({1.01 * i, 3.0}, look);
  return verdict;
}

TEST(FrameWatch, TakesOnePlaceThatAgreesForTheSameFrame) {
  FrameWatch watch;
  EXPECT_EQ(after(watch, 3, {10, 100}), Verdict::kOpen);
  EXPECT_EQ(watch.add({9.0, 3.0}, {75, 100}), Verdict::kSame);
  EXPECT_EQ(watch.add({19.0, 3.0}, {0, 1000}), Verdict::kSame) << "it is final";
}

TEST(FrameWatch, TakesFourPlacesThatDoNotForAnother) {
  FrameWatch watch;
  EXPECT_EQ(after(watch, 3, {20, 100}), Verdict::kOpen);
  EXPECT_EQ(watch.add({9.0, 3.0}, {20, 100}), Verdict::kOther);
}

TEST(FrameWatch, IsInDoubtFromTheFirstPlaceThatDoesNotAgreeUntilItKnows) {
  FrameWatch watch;
  EXPECT_FALSE(watch.is_in_doubt());
  (void)watch.add({0.0, 0.0}, {0, 49});
  EXPECT_FALSE(watch.is_in_doubt());
  (void)watch.add({0.0, 0.0}, {0, 49});
  EXPECT_TRUE(watch.is_in_doubt());
  (void)watch.add({5.0, 0.0}, {90, 100});
  EXPECT_FALSE(watch.is_in_doubt());
}

TEST(FrameWatch, LeavesItOpenWhileARobotStandsWhereMuchWasMoved) {
  FrameWatch watch;
  for (int i = 0; i < 1000; ++i) {
    EXPECT_EQ(watch.add({0.0009 * i, 0.0}, {0, 100}), Verdict::kOpen);
  }
}

TEST(FrameWatch, LeavesPlacesOutWhereLittleIsKnown) {
  FrameWatch watch;
  EXPECT_EQ(after(watch, 10, {0, 49}), Verdict::kOpen);
  EXPECT_EQ(after(watch, 10, {0, 0}), Verdict::kOpen);
  EXPECT_EQ(after(watch, 4, {0, 1}), Verdict::kOther) << "what is seen at a place adds up";
}

TEST(FrameWatch, TakesABuildingThatWasRefurnishedForTheSameFrame) {
  FrameWatch watch;
  EXPECT_EQ(after(watch, 4, {40, 100}), Verdict::kSame);
}

}  // namespace
}  // namespace strata
