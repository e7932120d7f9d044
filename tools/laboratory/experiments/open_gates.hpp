// SPDX-License-Identifier: Apache-2.0
/// Gates onto nothing, which only beams without return show as open; and glass walls.
#pragma once

#include <cstdint>

#include "tools/laboratory/experiments/simulated_maps.hpp"
#include "tools/simulate/scenario.hpp"

namespace strata::experiments {

/// A hall of 9 to 15 m by 6 to 9 m with a gate of 2 to 3.5 m in its north wall, beyond which
/// nothing is within the scanner's reach of 8 m. The gate is open on three days of six and closed
/// on the others, in an order by chance; somebody walks about. The robot drives past it to and fro.
[[nodiscard]] simulate::ScenarioConfig hall_with_gate(std::uint64_t seed);

/// The same hall without a gate: glass in its place, from which beams return that meet it within 8
/// to 25 degrees of its normal; all others pass and meet nothing. Nothing changes.
[[nodiscard]] simulate::ScenarioConfig hall_with_glass(std::uint64_t seed);

/// What the log learner makes of it, at poses with errors.
[[nodiscard]] Judgement learn_hall(const simulate::ScenarioConfig& hall, std::uint64_t seed,
                                   const PoseNoise& noise);

}  // namespace strata::experiments
