// SPDX-License-Identifier: Apache-2.0
#include "components/beam_filter/register.hpp"

#include "components/beam_filter/beam_filter.hpp"

namespace strata::beam_filter {

void register_component(runtime::Registry& registry) {
  registry.add<BeamFilter>("strata::BeamFilter");
}

}  // namespace strata::beam_filter
