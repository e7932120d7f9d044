// SPDX-License-Identifier: Apache-2.0
/// Experiments on learning patch maps [stachniss2005patch, section V], each for one seed.
#pragma once

#include <cstdint>
#include <string>

#include "tools/laboratory/experiments/simulated_maps.hpp"

namespace strata::experiments {

/// Figure 2: a hall with three doors far apart, six days, doors drawn open or closed each day (the
/// first two days: one closed, one open). scenario: three_doors.yaml.
[[nodiscard]] Judgement three_doors(const std::string& scenario, std::uint64_t seed,
                                    const PoseNoise& noise);

/// Figure 8: `days` passes by one place in four states make as many configurations. scenario:
/// four_states.yaml (17 days).
[[nodiscard]] Judgement local_maps(const std::string& scenario, std::uint64_t seed,
                                   const PoseNoise& noise);

/// A random office on `days` days, changed or static (docs/theory/patch_maps.md, "Few visits").
[[nodiscard]] Judgement office_visits(std::uint64_t seed, int days, bool has_change,
                                      const PoseNoise& noise);

}  // namespace strata::experiments
