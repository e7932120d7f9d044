// SPDX-License-Identifier: Apache-2.0
/// Tests and benchmarks run with the SIMD target that the environment asks for.
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "tests/support/command.hpp"
#include "tests/support/every_target.hpp"

namespace strata {
namespace {

std::string this_program() { return test::quoted(std::filesystem::read_symlink("/proc/self/exe")); }

TEST(SimdTarget, IsTheOneThatIsAskedFor) {
  if (const char* const asked = std::getenv("STRATA_SIMD_TARGET")) {
    const std::int64_t targets = hwy::SupportedTargets() & HWY_TARGETS;
    EXPECT_STREQ(hwy::TargetName(targets), asked);
    return;
  }
  std::vector<std::string> names;
  test::for_every_target([&] { names.emplace_back(hwy::TargetName(hwy::SupportedTargets())); });
  for (const std::string& name : names) {
    const auto outcome = test::run_command("STRATA_SIMD_TARGET=" + name + " " + this_program() +
                                           " --gtest_filter=SimdTarget.IsTheOneThatIsAskedFor");
    EXPECT_EQ(outcome.code, 0) << outcome.out;
  }
}

TEST(SimdTarget, ThatIsNotThereEndsTheProgram) {
  const auto outcome = test::run_command("STRATA_SIMD_TARGET=none " + this_program() + " 2>&1");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.out, testing::HasSubstr("STRATA_SIMD_TARGET=none: not here; there are"));
}

}  // namespace
}  // namespace strata
