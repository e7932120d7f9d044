// SPDX-License-Identifier: Apache-2.0
/// `strata play`: a log goes out over DDS, and the program ends with it.
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/components/bus/domain.hpp"
#include "tests/components/player/drive.hpp"
#include "tests/components/runtime/host_fixture.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/test_data.hpp"
#include "tests/tools/strata/program.hpp"

namespace strata::tools {
namespace {

TEST(Play, PublishesALogWithAClockAndEndsAtItsEnd) {
  const test::TemporaryDirectory folder;
  test::write_drive(folder.path() / "bag", 30);  // a scan a second
  for (const char* mode : {"messages", "robot"}) {
    const auto participant = test::make_participant();
    test::Collector<sensor_msgs::msg::LaserScan> scans(participant, "/scan", "sensor_data");
    test::Collector<rosgraph_msgs::msg::Clock> clock(participant, "/clock", "default");
    test::ChildProcess play(
        {STRATA_PROGRAM, "play", (folder.path() / "bag").string(), "--mode", mode, "--rate", "10",
         "--transport", "loopback", "--domain", std::to_string(test::own_domain())},
        {}, test::ChildProcess::Errors::kMerged);
    EXPECT_FALSE(scans.wait_for(1).empty()) << mode;
    EXPECT_FALSE(clock.wait_for(1).empty()) << mode;
    const std::string said = play.rest();
    EXPECT_EQ(play.wait(), 0) << said;
    EXPECT_THAT(said, testing::StartsWith("playing "));
  }
}

TEST(Play, SaysWhatItCannotPlay) {
  const auto missing = test::run_strata("play /no/log 2>&1");
  EXPECT_EQ(missing.code, 2);
  EXPECT_EQ(missing.out, "strata play: error: /no/log: does not exist; check the path\n");
  const auto rate = test::run_strata("play /no/log --rate 0 2>&1");
  EXPECT_EQ(rate.code, 2);
  EXPECT_THAT(rate.out, testing::HasSubstr("--rate: 0 is not a number above 0; see"));
}

TEST(Play, AsACompositionIsExplainedBeforeItsLogIsThere) {
  const test::TemporaryDirectory folder;
  const std::string check = "cd " + test::quoted(folder.path()) +
                            " && '" STRATA_PROGRAM "' run '" STRATA_SOURCE_DIR
                            "/components/config/play.yaml' ";
  const auto told = test::run_command(check + "--check 2>&1");
  EXPECT_EQ(told.code, 0) << told.out;
  EXPECT_THAT(told.out, testing::HasSubstr("/scan"));
  EXPECT_THAT(told.out, testing::ContainsRegex("warning: /player: office.clf: is not there: .*; "
                                               "name the log, as in --set player.log=LOG"));
  const auto run = test::run_command(check + "2>&1");
  EXPECT_EQ(run.code, 2);
  EXPECT_THAT(run.out, testing::HasSubstr("office.clf: does not exist; "));
}

}  // namespace
}  // namespace strata::tools
