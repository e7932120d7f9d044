// SPDX-License-Identifier: Apache-2.0
#include "tools/strata/terminal_progress.hpp"

#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

TEST(TerminalProgress, PipedOutputIsAFewWholeLines) {
  std::ostringstream out;
  {
    TerminalProgress progress(out, Style::kLines, nullptr);
    for (std::size_t i = 0; i <= 1000; ++i) progress.update("match scans", i, 1000);
  }
  const std::string text = out.str();
  EXPECT_THAT(text, ::testing::HasSubstr("match scans 0/1000 (0%)\n"));
  EXPECT_THAT(text, ::testing::HasSubstr("match scans 1000/1000 (100%)"));
  EXPECT_THAT(text, ::testing::Not(::testing::HasSubstr("\r")));
  EXPECT_EQ(text.back(), '\n');
}

TEST(TerminalProgress, ABarRedrawsOneLineAndQuietSaysNothing) {
  std::ostringstream bar;
  TerminalProgress progress(bar, Style::kBar, nullptr);
  progress.update("match scans", 0, 2);
  progress.update("match scans", 2, 2);
  EXPECT_THAT(bar.str(), ::testing::HasSubstr("\r\033[K[" + std::string(24, '#') + "]"));
  std::ostringstream nothing;
  TerminalProgress quiet(nothing, Style::kQuiet, nullptr);
  quiet.update("match scans", 1, 2);
  EXPECT_EQ(nothing.str(), "");
}

}  // namespace
}  // namespace strata::tools
