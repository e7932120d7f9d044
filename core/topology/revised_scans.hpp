// SPDX-License-Identifier: Apache-2.0
/// The scans of a topology that revises another one.
#pragma once

#include <vector>

#include "core/topology/config.hpp"
#include "core/topology/evidence.hpp"
#include "core/topology/particle.hpp"
#include "core/topology/partition.hpp"
#include "core/topology/visit_log.hpp"

namespace strata::topology {

/// What the local clouds say under other labels than those of `from`: a visit whose landmark has
/// other visits before it than it had is expanded again (`candidate_evidence`), from the topology
/// of the visits before it, as if it came now. All others keep their factor, and so do those behind
/// the tenth such visit. Sorted by visit. O(such visits x optimization).
[[nodiscard]] std::vector<ScanFactor> revised_scans(const Particle& from, const Labels& labels,
                                                    VisitLog& log, const TopologyConfig& config);

}  // namespace strata::topology
