// SPDX-License-Identifier: Apache-2.0
#include "components/map_saver/register.hpp"

#include "components/map_saver/map_saver.hpp"

namespace strata::map_saver {

void register_component(runtime::Registry& registry) { registry.add<MapSaver>("strata::MapSaver"); }

}  // namespace strata::map_saver
