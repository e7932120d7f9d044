// SPDX-License-Identifier: Apache-2.0
/// mapping.yaml as it stands, beside a robot: what it makes is there after Ctrl-C.
#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <signal.h>

#include "components/maps/earlier_runs.hpp"
#include "components/maps/maps_folder.hpp"
#include "tests/components/bus/domain.hpp"
#include "tests/components/player/drive.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/command.hpp"
#include "tests/support/test_data.hpp"
#include "tests/tools/strata/program.hpp"

namespace strata::tools {
namespace {

class ShippedMapping : public testing::Test {
 protected:
  /// Maps a drive of 30 scans and ends as Ctrl-C does; how many scans the folder then has.
  std::size_t map_drive() {
    test::ChildProcess run({"sh", "-c",
                            "cd " + test::quoted(folder_.path()) +
                                " && exec " STRATA_PROGRAM " run " STRATA_SOURCE_DIR
                                "/components/config/mapping.yaml --set domain=" +
                                std::to_string(test::own_domain())},
                           {}, test::ChildProcess::Errors::kMerged);
    EXPECT_NE(run.wait_for_line("process "), "");
    const auto played = test::run_strata("play " + test::quoted(folder_.path() / "bag") +
                                         " --rate 10 --transport loopback --domain " +
                                         std::to_string(test::own_domain()) + " 2>&1");
    EXPECT_EQ(played.code, 0) << played.out;
    run.send(SIGINT);
    const std::string said = run.rest();
    EXPECT_EQ(run.wait(), 0) << said;
    const std::filesystem::path maps = folder_.path() / "maps";
    EXPECT_TRUE(std::filesystem::exists(maps / maps::kSummaryFile)) << said;
    return maps::read_earlier_runs(maps).scans.size();
  }
  const test::TemporaryDirectory folder_;
};

TEST_F(ShippedMapping, KeepsTheFolderMapsAndGoesOnWithIt) {
  test::write_drive(folder_.path() / "bag", 30);  // a scan a second
  const std::size_t first = map_drive();
  EXPECT_GT(first, 15U);
  EXPECT_GE(map_drive(), first);
}

}  // namespace
}  // namespace strata::tools
