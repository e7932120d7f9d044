// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "components/runtime/registry.hpp"

namespace strata::fleet_member {

/// Makes strata::FleetMember known.
void register_component(runtime::Registry& registry);

}  // namespace strata::fleet_member
