// SPDX-License-Identifier: Apache-2.0
/// What a program that does not end by itself says at its hard end.
#include <chrono>
#include <cstdio>
#include <thread>

#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include "tools/strata/interrupt.hpp"

namespace strata::tools {
namespace {

const char* name_of(Interrupt::Overdue why) {
  switch (why) {
    case Interrupt::Overdue::kGraceIsOver:
      return "grace is over";
    case Interrupt::Overdue::kUnwritten:
      return "unwritten";
    case Interrupt::Overdue::kHurried:
      return "hurried";
  }
  return "?";
}

/// Never looks at the flag, like work that hangs.
[[noreturn]] void hang(Interrupt& interrupt) {
  interrupt.set_on_overdue([](Interrupt::Overdue why) { std::fputs(name_of(why), stderr); });
  kill(getpid(), SIGTERM);
  for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
}

class Overdue : public testing::Test {
 protected:
  // With threads, a fork in the middle would be undefined.
  void SetUp() override { GTEST_FLAG_SET(death_test_style, "threadsafe"); }
};

TEST_F(Overdue, WorkWithNothingToWriteIsInterrupted) {
  EXPECT_EXIT(
      {
        Interrupt interrupt(0.05);
        hang(interrupt);
      },
      testing::ExitedWithCode(1), "^grace is over$");
}

TEST_F(Overdue, WorkThatHadAskedForTimeToWriteIsSaidToBeUnwritten) {
  EXPECT_EXIT(
      {
        Interrupt interrupt(1000);
        interrupt.set_grace(0.05);
        hang(interrupt);
      },
      testing::ExitedWithCode(1), "^unwritten$");
}

}  // namespace
}  // namespace strata::tools
