// SPDX-License-Identifier: Apache-2.0
#include "components/localizer/register.hpp"

#include "components/localizer/localizer.hpp"

namespace strata::localizer {

void register_component(runtime::Registry& registry) {
  registry.add<Localizer>("strata::Localizer");
}

}  // namespace strata::localizer
