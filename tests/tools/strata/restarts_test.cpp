// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/restarts.hpp"

#include <gtest/gtest.h>

namespace strata::tools {
namespace {

using runtime::Restart;
using std::chrono::milliseconds;
using std::chrono::seconds;

runtime::ProcessEntry process_with(Restart policy, double delay_s = 1.0) {
  runtime::ProcessEntry process;
  process.name = "p";
  process.restart = policy;
  process.restart_delay_s = delay_s;
  return process;
}

/// A process that ends as soon as it has been started; each delay before the next start.
class RestartsOf : public testing::Test {
 protected:
  std::vector<double> delays(const runtime::ProcessEntry& process, int count, bool failed) {
    std::vector<double> result;
    for (int i = 0; i < count; ++i) {
      restarts_.started(process.name, now_);
      const auto delay = restarts_.plan(process, failed, now_);
      if (!delay) break;
      result.push_back(delay->count());
      now_ += std::chrono::duration_cast<Restarts::Clock::duration>(*delay);
    }
    return result;
  }
  Restarts restarts_;
  Restarts::Clock::time_point now_{seconds(1000)};
};

TEST_F(RestartsOf, TheDelayDoublesWithEachEndInARowToAMinuteAtMost) {
  EXPECT_EQ(delays(process_with(Restart::kOnFailure, 0.5), 9, true),
            (std::vector<double>{0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 60.0, 60.0}));
}

TEST_F(RestartsOf, TheDelayStaysWhatItIsHoweverOftenAProcessEnds) {
  constexpr int kOften = 3000;
  EXPECT_EQ(delays(process_with(Restart::kOnFailure, 0.0), kOften, true),
            std::vector<double>(kOften, 0.0));
  EXPECT_EQ(delays(process_with(Restart::kOnFailure, 1e-9), kOften, true).back(), 60.0);
}

TEST_F(RestartsOf, AProcessThatRanForAWhileHasACleanRecord) {
  const auto process = process_with(Restart::kOnFailure);
  EXPECT_EQ(delays(process, 3, true), (std::vector<double>{1.0, 2.0, 4.0}));
  restarts_.started(process.name, now_);
  now_ += seconds(61);
  EXPECT_EQ(restarts_.plan(process, true, now_)->count(), 1.0);
  restarts_.started(process.name, now_);
  now_ += seconds(59);
  EXPECT_EQ(restarts_.plan(process, true, now_)->count(), 2.0) << "not for long enough";
}

TEST_F(RestartsOf, ThePolicySaysAfterWhichEndsThereIsANextStart) {
  for (const bool failed : {false, true}) {
    EXPECT_FALSE(restarts_.plan(process_with(Restart::kNever), failed, now_)) << failed;
    EXPECT_TRUE(restarts_.plan(process_with(Restart::kAlways), failed, now_)) << failed;
    EXPECT_EQ(restarts_.plan(process_with(Restart::kOnFailure), failed, now_).has_value(), failed);
  }
}

TEST_F(RestartsOf, AProcessIsDueOnceWhenItsDelayIsOver) {
  const auto process = process_with(Restart::kAlways, 2.0);
  EXPECT_FALSE(restarts_.is_due("p", now_)) << "it has never ended";
  restarts_.started("p", now_);
  EXPECT_FALSE(restarts_.is_due("p", now_ + seconds(100))) << "it runs";
  (void)restarts_.plan(process, false, now_);
  EXPECT_FALSE(restarts_.is_due("p", now_ + milliseconds(1999)));
  EXPECT_TRUE(restarts_.is_due("p", now_ + milliseconds(2000)));
  restarts_.started("p", now_ + seconds(2));
  EXPECT_FALSE(restarts_.is_due("p", now_ + seconds(100)));
}

}  // namespace
}  // namespace strata::tools
