// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "components/runtime/registry.hpp"

namespace strata::patch_learner {

/// Makes strata::PatchLearner known.
void register_component(runtime::Registry& registry);

}  // namespace strata::patch_learner
