// SPDX-License-Identifier: Apache-2.0
#include "components/incident_recorder/register.hpp"

#include "components/incident_recorder/incident_recorder.hpp"

namespace strata::incident_recorder {

void register_component(runtime::Registry& registry) {
  registry.add<IncidentRecorder>("strata::IncidentRecorder");
}

}  // namespace strata::incident_recorder
