// SPDX-License-Identifier: Apache-2.0
/// A map to localize in, made of a floor plan alone.
#pragma once

#include "core/grid/reflection_grid.hpp"
#include "core/plan/plan_registration.hpp"

namespace strata::plan {

/// Drawn walls (core/plan/drawn_walls.hpp) are occupied; what one can walk to from the edge of the
/// picture through gaps wider than 1.4 m is unknown: there is no floor. All else is free, though
/// furniture may stand there. O(cells).
[[nodiscard]] ReflectionGrid map_of_plan(const ReflectionGrid& drawing,
                                         const SiteFromPlan& site_from_plan, double cell_m);

}  // namespace strata::plan
