// SPDX-License-Identifier: Apache-2.0
#include "components/map_server/register.hpp"

#include "components/map_server/map_server.hpp"

namespace strata::map_server {

void register_component(runtime::Registry& registry) {
  registry.add<MapServer>("strata::MapServer");
}

}  // namespace strata::map_server
