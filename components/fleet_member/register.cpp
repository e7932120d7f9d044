// SPDX-License-Identifier: Apache-2.0
#include "components/fleet_member/register.hpp"

#include "components/fleet_member/fleet_member.hpp"

namespace strata::fleet_member {

void register_component(runtime::Registry& registry) {
  registry.add<FleetMember>("strata::FleetMember");
}

}  // namespace strata::fleet_member
