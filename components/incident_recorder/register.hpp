// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "components/runtime/registry.hpp"

namespace strata::incident_recorder {

/// Makes strata::IncidentRecorder known.
void register_component(runtime::Registry& registry);

}  // namespace strata::incident_recorder
