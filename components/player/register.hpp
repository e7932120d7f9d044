// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "components/runtime/registry.hpp"

namespace strata::player {

/// Makes strata::Player known.
void register_component(runtime::Registry& registry);

}  // namespace strata::player
