// SPDX-License-Identifier: Apache-2.0
/// The parameters of nav2's AMCL (Humble to Kilted, and what came later as far as known) in ours.
#pragma once

#include "components/runtime/stand_in.hpp"

namespace strata::localizer {

/// The localizer in the place of a node named amcl. What its parameters become depends on the map
/// model: only occupancy and filtered have AMCL's likelihood field. docs/nav2.md has the table.
[[nodiscard]] runtime::StandIn amcl_stand_in();

}  // namespace strata::localizer
