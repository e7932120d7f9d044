// SPDX-License-Identifier: Apache-2.0
#include "components/topology_mapper/register.hpp"

#include "components/topology_mapper/topology_mapper.hpp"

namespace strata::topology_mapper {

void register_component(runtime::Registry& registry) {
  registry.add<TopologyMapper>("strata::TopologyMapper");
}

}  // namespace strata::topology_mapper
