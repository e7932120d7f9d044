// SPDX-License-Identifier: Apache-2.0
/// The filter over a whole drive.
#pragma once

#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "core/topology/topology_filter.hpp"

namespace strata::topology::test_world {

/// What the filter makes of the visits, all of which it takes.
inline std::vector<Hypothesis> posterior_of(const std::vector<LandmarkVisit>& visits,
                                            const TopologyConfig& config, std::uint64_t seed = 1,
                                            int threads = 1) {
  TopologyFilter filter(config, seed, threads);
  for (const LandmarkVisit& visit : visits) EXPECT_TRUE(filter.add(visit));
  return filter.posterior();
}

}  // namespace strata::topology::test_world
