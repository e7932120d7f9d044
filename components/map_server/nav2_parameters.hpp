// SPDX-License-Identifier: Apache-2.0
/// The parameters of nav2's map_server in ours.
#pragma once

#include "components/runtime/stand_in.hpp"

namespace strata::map_server {

/// Strata's map_server in the place of nav2's.
[[nodiscard]] runtime::StandIn nav2_stand_in();

}  // namespace strata::map_server
