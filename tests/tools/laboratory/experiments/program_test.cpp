// SPDX-License-Identifier: Apache-2.0
/// `strata-experiments` on a command line that is wrong.
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/command.hpp"
#include "tests/support/test_data.hpp"

namespace strata::experiments {
namespace {

TEST(ExperimentsProgram, NamesLimitsThatPeopleCanRead) {
  for (const char* option : {"--seeds", "--particles", "--radius", "--days"}) {
    const auto ended =
        test::run_command(std::string("'" STRATA_EXPERIMENTS "' year ") + option + " -1 2>&1");
    EXPECT_NE(ended.code, 0) << option;
    EXPECT_THAT(ended.out, testing::HasSubstr(std::string(option) + ": Value -1 not in range"));
    EXPECT_LT(ended.out.size(), 200U) << ended.out;
  }
}

/// One command line.
test::Outcome experiment(const std::string& arguments) {
  return test::run_command("'" STRATA_EXPERIMENTS "' " + arguments + " 2>&1");
}

TEST(ExperimentsProgram, PrintsTheSameOfShardsAsOfOneRun) {
  const test::TemporaryDirectory dir;
  const auto at = [&](const std::string& name) { return "'" + (dir.path() / name).string() + "'"; };
  const std::string seeds = "few_visits --seeds 2 --first-seed 5 ";
  const test::Outcome whole = experiment(seeds);
  ASSERT_EQ(whole.code, 0) << whole.out;
  for (const char* shard : {"1", "2", "3"}) {
    const test::Outcome one =
        experiment(seeds + "--shard " + shard + "/3 --out " + at(std::string("s") + shard));
    ASSERT_EQ(one.code, 0) << one.out;
    EXPECT_THAT(one.out, testing::HasSubstr("of 8 units"));
  }
  EXPECT_EQ(experiment(seeds + "--merge " + at("s3") + " " + at("s1") + " " + at("s2")).out,
            whole.out);
  EXPECT_THAT(experiment(seeds + "--merge " + at("s1") + " " + at("s3")).out,
              testing::HasSubstr("has no shard 2/3; run the same command again with --shard 2/3"));
  EXPECT_THAT(experiment("few_visits --seeds 3 --first-seed 5 --merge " + at("s1") + " " +
                         at("s2") + " " + at("s3"))
                  .out,
              testing::HasSubstr("--seeds differs"));
}

TEST(ExperimentsProgram, SaysWhichExperimentsHaveNoShards) {
  const test::Outcome year = experiment("year --shard 1/2");
  EXPECT_EQ(year.code, 1);
  EXPECT_THAT(year.out, testing::HasSubstr("are for experiments over seeds"));
}

}  // namespace
}  // namespace strata::experiments
