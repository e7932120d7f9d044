// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "core/random/stream.hpp"
#include "memory/decoding/relax_kernel.hpp"
#include "tests/support/every_target.hpp"

namespace strata::memory::detail {
namespace {

TEST(RelaxKernel, GivesThePlainLoopsBitsOnEveryTarget) {
  constexpr std::size_t kStates = 7;
  constexpr std::size_t kWidth = 6;  // four at a time, and two more
  constexpr std::size_t kStride = 2 * kStartLanes;
  RandomStream random(1, StreamId::kTest);
  std::vector<double> from(kStates * kStride);
  std::vector<double> edges(kStates * kWidth);
  for (double& cost : from) cost = random.uniform(0.0, 9.0);
  for (double& cost : edges) cost = random.uniform(0.0, 9.0);
  std::vector<double> expected(kWidth * kStride, std::numeric_limits<double>::infinity());
  for (std::size_t j = 0; j < kWidth; ++j) {
    for (std::size_t i = 0; i < kStates; ++i) {
      for (std::size_t s = 0; s < kStride; ++s) {
        double& least = expected[j * kStride + s];
        least = std::min(least, from[i * kStride + s] + edges[i * kWidth + j]);
      }
    }
  }
  test::for_every_target([&] {
    std::vector<double> to(expected.size());
    relax(from.data(), edges.data(), kStates, kWidth, kStride, to.data());
    EXPECT_EQ(to, expected);
  });
}

}  // namespace
}  // namespace strata::memory::detail
