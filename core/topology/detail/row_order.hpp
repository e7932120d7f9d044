// SPDX-License-Identifier: Apache-2.0
/// In which order the poses of one topology are eliminated.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "core/topology/block_pattern.hpp"
#include "core/topology/detail/terms.hpp"
#include "core/topology/location_gaussian.hpp"

namespace strata::topology::detail {

/// Which two visits, neither of them the first, have a factor between them.
using Touching = std::vector<std::pair<std::size_t, std::size_t>>;

/// near: of the terms' landmarks within the penalty's radius.
[[nodiscard]] Touching touching(const Terms& terms, const LocationPriorConfig& config,
                                std::span<const Pose2> poses, NearPairs& near);

/// Where the information has blocks. rows: of each visit.
[[nodiscard]] BlockPattern pattern_of(const Touching& pairs, const std::vector<int>& rows);

/// The row of each visit; of the first one unused. Those of few fill-ins (minimum degree, by whole
/// poses), or those of `before` with the newest visit behind them, unless it is null or of another
/// number of visits; from time to time, by the number of visits alone, they are looked for again.
[[nodiscard]] std::vector<int> rows_after(const LocationGaussian* before, const Touching& pairs,
                                          std::size_t visits);

}  // namespace strata::topology::detail
