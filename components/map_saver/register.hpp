// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "components/runtime/registry.hpp"

namespace strata::map_saver {

/// Makes strata::MapSaver known.
void register_component(runtime::Registry& registry);

}  // namespace strata::map_saver
