// SPDX-License-Identifier: Apache-2.0
/// A floor plan over the map.
#pragma once

#include "core/grid/reflection_grid.hpp"
#include "core/plan/plan_registration.hpp"
#include "tools/report/image.hpp"

namespace strata::site {

/// What is drawn in red over the map, which may be empty.
[[nodiscard]] report::Image draw_plan(const ReflectionGrid& drawing,
                                      const plan::SiteFromPlan& site_from_plan,
                                      const ReflectionGrid& map);

}  // namespace strata::site
