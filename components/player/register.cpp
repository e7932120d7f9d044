// SPDX-License-Identifier: Apache-2.0
#include "components/player/register.hpp"

#include "components/player/player.hpp"

namespace strata::player {

void register_component(runtime::Registry& registry) { registry.add<Player>("strata::Player"); }

}  // namespace strata::player
