// SPDX-License-Identifier: Apache-2.0
/// Zones over the map.
#pragma once

#include "components/site/zones.hpp"
#include "core/grid/reflection_grid.hpp"
#include "tools/report/image.hpp"

namespace strata::site {

/// Borders in colours: keepout red, speed orange, preferred green, and of what may be learned blue
/// (nothing), purple (nothing that changes) or grey (everything). rect: to be shown.
[[nodiscard]] report::Image draw_zones(const Zones& zones, const ReflectionGrid& map,
                                       const CellRect& rect);

}  // namespace strata::site
