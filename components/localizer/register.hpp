// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "components/runtime/registry.hpp"

namespace strata::localizer {

/// Makes strata::Localizer known.
void register_component(runtime::Registry& registry);

}  // namespace strata::localizer
