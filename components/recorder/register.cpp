// SPDX-License-Identifier: Apache-2.0
#include "components/recorder/register.hpp"

#include "components/recorder/recorder.hpp"

namespace strata::recorder {

void register_component(runtime::Registry& registry) { registry.add<Recorder>("strata::Recorder"); }

}  // namespace strata::recorder
