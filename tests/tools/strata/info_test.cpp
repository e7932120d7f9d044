// SPDX-License-Identifier: Apache-2.0
/// `strata info` of what is no log of scans: other bags, and folders that verbs wrote.
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "components/log/bag.hpp"
#include "tests/support/test_data.hpp"
#include "tests/tools/strata/program.hpp"
#include "tests/tools/strata/replay_fixture.hpp"

namespace fs = std::filesystem;

namespace strata::tools {
namespace {

using nlohmann::json;
using test::quoted;
using test::run_strata;
using ::testing::HasSubstr;

/// Three messages of a battery, two seconds apart.
void write_bag(const fs::path& path, log::BagStorage storage) {
  log::BagWriter bag(path, storage);
  const std::size_t topic = bag.add_topic({"/battery", "sensor_msgs/msg/BatteryState", "cdr", ""});
  (void)bag.add_topic({"/never", "std_msgs/msg/String", "cdr", ""});
  for (int i = 0; i < 3; ++i) {
    bag.write(topic, Stamp{(10 + 2LL * i) * 1'000'000'000LL},
              std::vector<std::uint8_t>{0, 1, 0, 0});
  }
  bag.close();
}

TEST(Info, ShowsTheTopicsOfABagWithoutScans) {
  for (const auto storage : {log::BagStorage::kSqlite3, log::BagStorage::kMcap}) {
    const test::TemporaryDirectory folder;
    const fs::path bag = folder.path() / "bag";
    write_bag(bag, storage);
    const auto told = run_strata("info " + quoted(bag) + " 2>&1");
    EXPECT_EQ(told.code, 0);
    EXPECT_THAT(told.out, HasSubstr("bag folder"));
    EXPECT_THAT(told.out, HasSubstr("duration   4.0 s\n"));
    EXPECT_THAT(told.out, HasSubstr("    /battery 3, 0.75 Hz, sensor_msgs/msg/BatteryState\n"));
    EXPECT_THAT(told.out, HasSubstr("    /never 0, 0.00 Hz, std_msgs/msg/String\n"));
    EXPECT_THAT(told.out, HasSubstr("not read as a log of scans: " + bag.string() +
                                    ": no sensor_msgs/msg/LaserScan can be read\n"));
    const json info = json::parse(run_strata("info --json --quiet " + quoted(bag)).out);
    EXPECT_TRUE(info["scans"].is_null());
    EXPECT_EQ(info["messages"]["/battery"]["count"], 3);
  }
}

TEST(Info, OfNoLogAtAllStillSaysWhatIsWrong) {
  const test::TemporaryDirectory folder;
  const auto told = run_strata("info " + quoted(folder.path()) + " 2>&1");
  EXPECT_EQ(told.code, 2);
  EXPECT_THAT(told.out, ::testing::StartsWith("strata info: error: " + folder.path().string()));
}

class InfoOfFolders : public test::ReplayFixture {};

TEST_F(InfoOfFolders, SaysWhatMapsWereLearnedFromAndWhatIsThere) {
  const fs::path maps = at("direct");
  const auto told = run_strata("info " + quoted(maps) + " 2>&1");
  ASSERT_EQ(told.code, 0) << told.out;
  EXPECT_THAT(told.out,
              ::testing::StartsWith(maps.string() + ": maps, as `strata learn` writes them\n"));
  EXPECT_THAT(told.out, ::testing::ContainsRegex("learned    from [0-9]+ scans of 1 run, "));
  EXPECT_THAT(told.out, HasSubstr("file       occupancy.pgm, "));
  EXPECT_THAT(told.out, HasSubstr("folder     patches\n"));
  EXPECT_THAT(told.out, HasSubstr("grid       filtered, "));
  const json info = json::parse(run_strata("info --json " + quoted(maps)).out);
  EXPECT_EQ(info["kind"], "maps");
  EXPECT_EQ(info["summary"]["runs"], 1);
  EXPECT_FALSE(info["store"]["grids"].empty());
}

TEST_F(InfoOfFolders, TellsFoldersOfOtherVerbsApart) {
  const fs::path out = at("localized");
  ASSERT_EQ(run_strata("localize " + quoted(log()) + " --quiet --initial-pose 0,0,0 --maps " +
                       quoted(at("direct")) + " --model filtered --out " + quoted(out))
                .code,
            0);
  EXPECT_THAT(run_strata("info " + quoted(out)).out,
              HasSubstr(": a localized run, as `strata localize` writes it\n"));
}

}  // namespace
}  // namespace strata::tools
