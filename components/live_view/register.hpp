// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "components/runtime/registry.hpp"

namespace strata::live_view {

/// Makes strata::LiveView known.
void register_component(runtime::Registry& registry);

}  // namespace strata::live_view
