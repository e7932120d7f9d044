// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "components/runtime/registry.hpp"

namespace strata::topology_mapper {

/// Makes strata::TopologyMapper known.
void register_component(runtime::Registry& registry);

}  // namespace strata::topology_mapper
