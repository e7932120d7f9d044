// SPDX-License-Identifier: Apache-2.0
/// Floor plans of simulated buildings, as people draw them.
#pragma once

#include <cstdint>

#include "core/grid/reflection_grid.hpp"
#include "core/plan/plan_registration.hpp"
#include "tools/simulate/simulation.hpp"

namespace strata::experiments {

struct DrawnPlan {
  ReflectionGrid drawing;             ///< occupied where something is drawn
  plan::SiteFromPlan site_from_plan;  ///< the truth
  double thick_m = 0.0;               ///< of walls; 0: single lines
  bool is_cut = false;                ///< it ends before the building
};

/// Walls without furniture and boxes, turned and shifted by anything, at 1 to 4 cm a pixel and with
/// a scale that is wrong by up to 0.5%. Walls are single lines, bars or double lines of any
/// thickness up to 0.25 m, a tenth of the inner ones is missing. Doors are gaps, closed, or open
/// with an arc. Some plans end before the building or show a wing more. There are words, and mostly
/// a frame.
[[nodiscard]] DrawnPlan draw_plan(const simulate::Simulation& building, std::uint64_t seed);

}  // namespace strata::experiments
