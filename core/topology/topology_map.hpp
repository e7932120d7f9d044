// SPDX-License-Identifier: Apache-2.0
/// What a whole run says: its topologies, and the metric map that the likeliest one implies
/// [ranganathan2006rao, section V; lu1997globally].
#pragma once

#include <vector>

#include "core/base/progress.hpp"
#include "core/geometry/pose2_gaussian.hpp"
#include "core/grid/reflection_grid.hpp"
#include "core/scan/scan.hpp"
#include "core/topology/topology_filter.hpp"
#include "core/topology/topology_mapper.hpp"
#include "core/topology/visit_maker.hpp"

namespace strata::topology {

struct TopologyMap {
  std::vector<MadeVisit> visits;
  std::vector<Hypothesis> posterior;  ///< most probable first; empty without a landmark
  /// Of the most probable hypothesis: pose of every visit, in the frame of the first scan.
  std::vector<Pose2Gaussian> locations;
  std::vector<int> place_names;  ///< ... and number of each landmark, by label (PlaceNames)
  TopologyCounts counts;
  bool optimized = false;        ///< the pose graph converged
  std::vector<PosedScan> scans;  ///< with their poses after optimization
  std::vector<Pose2> tracked;    ///< ... and before
  ReflectionGrid map;
};

/// After `finish` and the updates that it asked for. Consecutive scans and the local clouds that
/// the likeliest topology registered to each other hold each other; then passes that overlap are
/// registered to each other, and every scan is matched to the map of all. Throws Cancelled.
/// O(rounds x scans x beams), and the closures of slam::LocalMapGraph.
[[nodiscard]] TopologyMap make_topology_map(const TopologyMapper& mapper,
                                            Progress* progress = nullptr);

}  // namespace strata::topology
