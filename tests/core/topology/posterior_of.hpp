// SPDX-License-Identifier: Apache-2.0
/// The filter over a whole drive.
#pragma once

#include <cmath>
#include <cstdint>
#include <map>
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

/// Half the sum of what two laws over topologies differ by: 0 for equal ones, 1 at most.
inline double total_variation(const std::vector<Hypothesis>& a, const std::vector<Hypothesis>& b) {
  std::map<Labels, double> difference;
  for (const Hypothesis& hypothesis : a) difference[hypothesis.labels] += hypothesis.probability;
  for (const Hypothesis& hypothesis : b) difference[hypothesis.labels] -= hypothesis.probability;
  double sum = 0.0;
  for (const auto& [labels, value] : difference) sum += std::abs(value);
  return 0.5 * sum;
}

}  // namespace strata::topology::test_world
