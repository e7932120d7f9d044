// SPDX-License-Identifier: Apache-2.0
/// What an experiment comes to over several seeds, printed.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "tools/laboratory/experiments/patch_localization.hpp"
#include "tools/laboratory/experiments/simulated_maps.hpp"
#include "tools/shards/units.hpp"

namespace strata::experiments {

struct Seeds {
  std::uint64_t first = 1;
  int count = 20;
};

/// Sums of the judgements, one a seed.
void report_learning(const std::string& name, const Seeds& seeds, shards::Units& units,
                     const std::function<Judgement(std::uint64_t)>& one);

/// Means of the outcomes of each model.
void report_localizing(const std::string& name, const Seeds& seeds, shards::Units& units,
                       const std::function<Outcomes(std::uint64_t)>& one);

}  // namespace strata::experiments
