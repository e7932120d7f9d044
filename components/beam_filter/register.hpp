// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "components/runtime/registry.hpp"

namespace strata::beam_filter {

/// Makes strata::BeamFilter known.
void register_component(runtime::Registry& registry);

}  // namespace strata::beam_filter
