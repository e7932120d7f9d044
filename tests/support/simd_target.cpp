// SPDX-License-Identifier: Apache-2.0
/// STRATA_SIMD_TARGET=AVX2 in the environment of a test or benchmark: its kernels run as on a
/// machine whose best SIMD target that is. Linked into each of these programs, never into others.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include <hwy/targets.h>

namespace strata::test {
namespace {

/// Dispatch goes to the target that the environment asks for; ends the program where there is none
/// of that name here.
bool use_asked_target() {
  const char* const asked = std::getenv("STRATA_SIMD_TARGET");
  if (asked == nullptr) return false;
  const std::int64_t here = hwy::SupportedTargets() & HWY_TARGETS;
  for (std::int64_t left = here; left != 0; left &= left - 1) {
    const std::int64_t target = left & -left;
    if (std::strcmp(hwy::TargetName(target), asked) != 0) continue;
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    return true;
  }
  std::fprintf(stderr, "STRATA_SIMD_TARGET=%s: not here; there are", asked);
  for (std::int64_t left = here; left != 0; left &= left - 1) {
    std::fprintf(stderr, " %s", hwy::TargetName(left & -left));
  }
  std::fprintf(stderr, "\n");
  std::exit(2);
}

[[maybe_unused]] const bool is_asked = use_asked_target();

}  // namespace
}  // namespace strata::test
