// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/terminal_progress.hpp"

#include <chrono>
#include <cstddef>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/peak_memory.hpp"

namespace strata::tools {
namespace {

using Style = TerminalProgress::Style;

TEST(ProgressText, StatesRateAndTimeLeft) {
  EXPECT_EQ(progress_text("match scans", 100, 400, 100, 4.0),
            "match scans 100/400 (25%), 25/s, 0:12 left");
  EXPECT_EQ(progress_text("read log", 50, 0, 50, 100.0), "read log 50, 0.50/s");
  EXPECT_EQ(progress_text("start", 0, 10, 0, 0.0), "start 0/10 (0%)");
  EXPECT_EQ(format_duration(3765.4), "1:02:45");
  EXPECT_EQ(format_duration(59.6), "1:00");
}

/// A clock that is set by hand.
class Progressing : public testing::Test {
 protected:
  TerminalProgress make(Style style) {
    return {out_, style, nullptr, [this] { return now_; }};
  }
  void pass(double seconds) {
    now_ += std::chrono::duration_cast<std::chrono::steady_clock::duration>(
        std::chrono::duration<double>(seconds));
  }
  [[nodiscard]] std::string text() const { return out_.str(); }

 private:
  std::ostringstream out_;
  TerminalProgress::Time now_;
};

TEST_F(Progressing, ReturnsWhatAStageFreedToTheSystem) {
  TerminalProgress progress = make(Style::kQuiet);
  progress.update("count", 0, 1);
  // Small blocks, and one behind them that stays: glibc cannot shrink its heap by itself.
  constexpr std::size_t kBlock = 10'000;
  constexpr std::size_t kBlocks = 10'000;
  std::vector<std::unique_ptr<std::byte[]>> blocks;
  for (std::size_t i = 0; i < kBlocks; ++i) blocks.push_back(std::make_unique<std::byte[]>(kBlock));
  const auto behind = std::make_unique<std::byte[]>(kBlock);
  blocks.clear();
  const std::size_t before = test::status_bytes("VmRSS");
  if (before < kBlock * kBlocks) GTEST_SKIP() << "the system has it back already";
  progress.update("count", 1, 1);
  EXPECT_GT(test::status_bytes("VmRSS"), kBlock * kBlocks) << "within a stage nothing is done";
  progress.update("label", 0, 1);
  EXPECT_LT(test::status_bytes("VmRSS") + kBlock * kBlocks / 2, before);
}

TEST_F(Progressing, InAPipeIsAFewWholeLines) {
  {
    TerminalProgress progress = make(Style::kLines);
    for (std::size_t i = 0; i <= 1000; ++i) {
      progress.update("match scans", i, 1000);
      pass(0.0125);
    }
  }
  EXPECT_EQ(text(),
            "match scans 80/1000 (8%), 80/s, 0:12 left\n"
            "match scans 880/1000 (88%), 80/s, 0:02 left\n"
            "match scans 1000/1000 (100%), 80/s\n");
}

TEST_F(Progressing, InAPipeLeavesOutStagesThatAreOverInASecond) {
  TerminalProgress progress = make(Style::kLines);
  for (const char* stage : {"label beams", "match again", "label beams"}) {
    for (std::size_t i = 0; i <= 10; ++i) {
      progress.update(stage, i, 10);
      pass(0.09);
    }
  }
  EXPECT_EQ(text(), "");
}

TEST_F(Progressing, OnATerminalIsOneLineThatIsRewrittenAndGoneAtTheEnd) {
  {
    TerminalProgress progress = make(Style::kBar);
    progress.update("read log", 0, 2);
    progress.update("read log", 2, 2);
    pass(0.9);
    progress.update("match scans", 0, 2);
    EXPECT_EQ(text(), "") << "what is over in a second leaves nothing";
    pass(0.2);
    progress.update("match scans", 1, 2);
    pass(0.01);
    progress.update("match scans", 2, 2);
    progress.update("label beams", 1, 2);
  }
  const std::string wiped = "\r\033[K";
  EXPECT_THAT(text(), ::testing::HasSubstr(wiped + "[" + std::string(24, '#') + "] match scans"));
  EXPECT_THAT(text(), ::testing::Not(::testing::HasSubstr("label beams")));
  EXPECT_THAT(text(), ::testing::Not(::testing::HasSubstr("\n")));
  EXPECT_THAT(text(), ::testing::EndsWith(wiped));
}

TEST_F(Progressing, QuietlySaysNothing) {
  TerminalProgress progress = make(Style::kQuiet);
  pass(5.0);
  progress.update("match scans", 1, 2);
  EXPECT_EQ(text(), "");
}

}  // namespace
}  // namespace strata::tools
