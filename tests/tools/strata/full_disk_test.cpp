// SPDX-License-Identifier: Apache-2.0
/// A disk without space: one line that says so, exit code 1, and nothing left behind.
#include <algorithm>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "tests/tools/strata/replay_fixture.hpp"

namespace fs = std::filesystem;

namespace strata::tools {
namespace {

using test::Outcome;
using test::quoted;

class FullDisk : public test::ReplayFixture {
 protected:
  /// No file may become larger than a few kilobytes, which to a program is a full disk.
  void expect_one_line_and_nothing_left(const std::string& arguments, const std::string& out) {
    fs::create_directories(at("full"));
    const Outcome outcome = test::run_strata_under(
        "ulimit -f 8; trap '' XFSZ;",
        arguments + " --quiet " + out + quoted(at("full") / "out") + " 2>&1");
    EXPECT_EQ(outcome.code, 1) << outcome.out;
    EXPECT_NE(outcome.out.find(": error: "), std::string::npos) << outcome.out;
    EXPECT_NE(outcome.out.find("; "), std::string::npos) << "no remedy: " << outcome.out;
    EXPECT_EQ(std::count(outcome.out.begin(), outcome.out.end(), '\n'), 1) << outcome.out;
    EXPECT_TRUE(fs::is_empty(at("full"))) << *fs::directory_iterator(at("full"));
  }
};

TEST_F(FullDisk, EndsEveryVerbThatWritesWithOneLineAndNothingLeft) {
  std::ofstream(at("landmarks.txt")) << "1\n5\n9\n";
  for (const std::string& arguments :
       {"learn " + quoted(log()), "localize " + quoted(log()) + " --maps " + quoted(at("direct")),
        "topology " + quoted(log()) + " --landmarks " + quoted(at("landmarks.txt")),
        "simulate " + quoted(scenario()), "compare --seeds 1 " + quoted(log()),
        "replay " + quoted(log()) + " --composition " +
            quoted(test::kCompositions / "mapping.yaml") +
            " --set domain=" + std::to_string(test::own_domain())}) {
    SCOPED_TRACE(arguments);
    expect_one_line_and_nothing_left(arguments, "--out ");
  }
  for (const std::string format : {"carmen", "sqlite3", "mcap"}) {
    SCOPED_TRACE(format);
    expect_one_line_and_nothing_left("convert " + quoted(log()) + " --to " + format, "");
  }
}

}  // namespace
}  // namespace strata::tools
