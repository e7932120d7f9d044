// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "components/runtime/registry.hpp"

namespace strata::volume_mapper {

/// Makes strata::VolumeMapper known.
void register_component(runtime::Registry& registry);

}  // namespace strata::volume_mapper
