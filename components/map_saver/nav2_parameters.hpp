// SPDX-License-Identifier: Apache-2.0
/// The parameters of nav2's map_saver in ours.
#pragma once

#include "components/runtime/stand_in.hpp"

namespace strata::map_saver {

/// Strata's map_saver in the place of nav2's.
[[nodiscard]] runtime::StandIn nav2_stand_in();

}  // namespace strata::map_saver
