// SPDX-License-Identifier: Apache-2.0
/// `strata convert`: every format, and nothing lost on the way.
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/test_data.hpp"
#include "tests/tools/strata/program.hpp"
#include "tests/tools/strata/small_logs.hpp"

namespace fs = std::filesystem;

namespace strata::tools {
namespace {

using test::Outcome;
using test::quoted;
using test::ros1_bag;
using test::run_strata;
using test::write_log;

TEST(Convert, MakesABagOfRos2OfOneOfRos1) {
  const test::TemporaryDirectory folder;
  const std::string copy = quoted(folder.path() / "copy.mcap");
  ASSERT_EQ(run_strata("convert --quiet " + quoted(ros1_bag()) + " " + copy).code, 0);
  const auto info = nlohmann::json::parse(run_strata("info --json --quiet " + copy).out);
  EXPECT_EQ(info["format"], "MCAP file");
  EXPECT_EQ(info["scans"]["count"], 3);
  EXPECT_EQ(info["odometry"]["source"], "/odom");
  const Outcome back =
      run_strata("convert --quiet " + copy + " " + quoted(folder.path() / "x.bag"));
  EXPECT_EQ(back.code, 2) << "bags of ROS 1 are not written";
}

TEST(Convert, GoesThroughEveryFormatAndBack) {
  const test::TemporaryDirectory folder;
  write_log(folder.path() / "a.clf", 5);
  const auto at = [&](const char* name) { return quoted(folder.path() / name); };
  EXPECT_EQ(run_strata("convert --quiet " + at("a.clf") + " " + at("b.mcap")).code, 0);
  EXPECT_EQ(run_strata("convert --quiet " + at("b.mcap") + " " + at("c.db3")).code, 0);
  EXPECT_EQ(run_strata("convert --quiet " + at("c.db3") + " " + at("d") + " --to mcap").code, 0);
  EXPECT_EQ(run_strata("convert --quiet " + at("d") + " " + at("e.clf") + " --from 1 --to 3").code,
            0);
  EXPECT_TRUE(fs::exists(folder.path() / "d" / "metadata.yaml"));
  const auto info = nlohmann::json::parse(run_strata("info --json --quiet " + at("e.clf")).out);
  EXPECT_EQ(info["scans"]["count"], 3);
  EXPECT_EQ(info["scans"]["no_returns"], 3);
}

TEST(Convert, PacksACarmenLogWhoseNameSaysSo) {
  const test::TemporaryDirectory folder;
  write_log(folder.path() / "a.clf", 3000);  // more than is packed at once
  const auto at = [&](const char* name) { return quoted(folder.path() / name); };
  ASSERT_EQ(run_strata("convert --quiet " + at("a.clf") + " " + at("b.clf")).code, 0);
  const Outcome packed =
      run_strata("convert --quiet " + at("a.clf") + " " + at("b.clf.gz") + " 2>&1");
  ASSERT_EQ(packed.code, 0) << packed.out;
  const std::string bytes = test::bytes_of(folder.path() / "b.clf.gz");
  EXPECT_EQ(bytes.substr(0, 2), "\x1f\x8b");
  EXPECT_EQ(test::run_command("zcat " + at("b.clf.gz")).out,
            test::bytes_of(folder.path() / "b.clf"));
  EXPECT_EQ(
      run_strata("convert --quiet " + at("a.clf") + " " + at("b.mcap.gz") + " 2>/dev/null").code,
      2);
}

TEST(Convert, DoesNotWriteOverWhatItReads) {
  const test::TemporaryDirectory folder;
  write_log(folder.path() / "a.clf", 5);
  const auto at = [&](const char* name) { return quoted(folder.path() / name); };
  const std::string before = test::bytes_of(folder.path() / "a.clf");
  ASSERT_EQ(run_strata("convert --quiet " + at("a.clf") + " " + at("bag") + " --to mcap").code, 0);
  fs::create_symlink("a.clf", folder.path() / "link.clf");
  for (const std::string& arguments :
       {at("a.clf") + " " + at("a.clf"), at("a.clf") + " " + at("link.clf"),
        at("bag") + " " + at("bag/bag_0.mcap"),
        at("bag/bag_0.mcap") + " " + at("bag/bag_0.mcap")}) {
    const Outcome outcome = run_strata("convert --quiet " + arguments + " 2>&1");
    EXPECT_EQ(outcome.code, 1) << arguments;
    EXPECT_NE(outcome.out.find("the log to convert; give OUT another name"), std::string::npos)
        << outcome.out;
  }
  EXPECT_EQ(test::bytes_of(folder.path() / "a.clf"), before);
  EXPECT_EQ(run_strata("info --quiet " + at("bag")).code, 0);
}

TEST(Convert, ThatFailsLeavesNothingBehind) {
  const test::TemporaryDirectory folder;
  write_log(folder.path() / "a.clf", 5);
  std::ofstream(folder.path() / "bad.clf") << "FLASER nonsense\n";
  const std::string good = quoted(folder.path() / "a.clf");
  EXPECT_EQ(
      run_strata("convert --quiet " + good + " " + quoted(folder.path() / "x.abc") + " 2>&1").code,
      2);
  EXPECT_EQ(run_strata("convert --quiet " + good + " /no/such/folder/x.clf 2>&1").code, 1);
  EXPECT_EQ(run_strata("convert --quiet " + quoted(folder.path() / "bad.clf") + " " +
                       quoted(folder.path() / "x.mcap") + " 2>&1")
                .code,
            2);
  std::size_t entries = 0;
  for ([[maybe_unused]] const auto& entry : fs::directory_iterator(folder.path())) ++entries;
  EXPECT_EQ(entries, 2U);
}

}  // namespace
}  // namespace strata::tools
