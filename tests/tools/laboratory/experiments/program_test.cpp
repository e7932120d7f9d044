// SPDX-License-Identifier: Apache-2.0
/// `strata-experiments` on a command line that is wrong.
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/command.hpp"

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

}  // namespace
}  // namespace strata::experiments
