// SPDX-License-Identifier: Apache-2.0
/// Runs a test once for each SIMD target that the machine has and the program holds, the one
/// without SIMD included.
#pragma once

#include <cstdint>

#include <gtest/gtest.h>
#include <hwy/targets.h>

namespace strata::test {

/// Calls body() with dispatch set to each target in turn; at least two, one of them without SIMD.
/// Whatever STRATA_SIMD_TARGET says, which holds again afterwards.
template <typename Body>
void for_every_target(Body&& body) {
  const std::int64_t before = hwy::SupportedTargets();
  hwy::SetSupportedTargetsForTest(0);
  std::int64_t done = 0;
  for (std::int64_t left = hwy::SupportedTargets() & HWY_TARGETS; left != 0; left &= left - 1) {
    const std::int64_t target = left & -left;
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    const ::testing::ScopedTrace trace(__FILE__, __LINE__, hwy::TargetName(target));
    body();
    done |= target;
    hwy::SetSupportedTargetsForTest(0);
  }
  hwy::SetSupportedTargetsForTest(before);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  EXPECT_NE(done & (HWY_SCALAR | HWY_EMU128), 0);
  EXPECT_NE(done & ~(HWY_SCALAR | HWY_EMU128), 0);
}

}  // namespace strata::test
