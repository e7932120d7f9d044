// SPDX-License-Identifier: Apache-2.0
/// A topology as others need it: without what only the filter goes on with.
#pragma once

#include <vector>

#include "core/geometry/pose2_gaussian.hpp"
#include "core/topology/partition.hpp"

namespace strata::topology {

struct TopologySummary {
  double probability = 0.0;
  double log_evidence = 0.0;
  Labels labels;                         ///< of each visit, canonical
  std::vector<Pose2Gaussian> landmarks;  ///< map_from_landmark at its first visit, by label
};

}  // namespace strata::topology
