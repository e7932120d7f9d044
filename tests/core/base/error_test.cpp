// SPDX-License-Identifier: Apache-2.0
#include "core/base/error.hpp"

#include <gtest/gtest.h>

#include "core/base/progress.hpp"

namespace strata {
namespace {

TEST(Error, SaysPlaceProblemAndRemedyInOneLine) {
  const InputError error("log.clf:7", "the line ends early", "record the log again");
  EXPECT_STREQ(error.what(), "log.clf:7: the line ends early; record the log again");
  EXPECT_EQ(error.place(), "log.clf:7");
  EXPECT_EQ(error.problem(), "the line ends early");
  EXPECT_EQ(error.remedy(), "record the log again");
}

TEST(Error, KindsAreToldApartAndShareABase) {
  EXPECT_THROW(throw ConfigError("a", "b", "c"), ConfigError);
  EXPECT_THROW(throw OutputError("a", "b", "c"), Error);
  EXPECT_THROW(throw Cancelled("a"), Error);
}

class Recorder : public Progress {
 public:
  void update(std::string_view stage, std::size_t done, std::size_t total) override {
    last = std::string(stage) + " " + std::to_string(done) + "/" + std::to_string(total);
  }
  [[nodiscard]] bool cancelled() const override { return stop; }
  std::string last;
  bool stop = false;
};

TEST(Progress, ReportsUntilTheUserStops) {
  Recorder progress;
  report_progress(&progress, "match scans", 3, 10);
  EXPECT_EQ(progress.last, "match scans 3/10");
  progress.stop = true;
  EXPECT_THROW(report_progress(&progress, "match scans", 4, 10), Cancelled);
  EXPECT_EQ(progress.last, "match scans 3/10");
  EXPECT_NO_THROW(report_progress(nullptr, "match scans", 4, 10));
}

}  // namespace
}  // namespace strata
