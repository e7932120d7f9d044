// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "components/runtime/registry.hpp"

namespace strata::timescale_memory {

/// Makes strata::TimescaleMemory known.
void register_component(runtime::Registry& registry);

}  // namespace strata::timescale_memory
