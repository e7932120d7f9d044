// SPDX-License-Identifier: Apache-2.0
#include "components/timescale_memory/register.hpp"

#include "components/timescale_memory/timescale_memory.hpp"

namespace strata::timescale_memory {

void register_component(runtime::Registry& registry) {
  registry.add<TimescaleMemory>("strata::TimescaleMemory");
}

}  // namespace strata::timescale_memory
