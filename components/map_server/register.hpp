// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "components/runtime/registry.hpp"

namespace strata::map_server {

/// Makes strata::MapServer known.
void register_component(runtime::Registry& registry);

}  // namespace strata::map_server
