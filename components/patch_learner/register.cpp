// SPDX-License-Identifier: Apache-2.0
#include "components/patch_learner/register.hpp"

#include "components/patch_learner/patch_learner.hpp"

namespace strata::patch_learner {

void register_component(runtime::Registry& registry) {
  registry.add<PatchLearner>("strata::PatchLearner");
}

}  // namespace strata::patch_learner
