// SPDX-License-Identifier: Apache-2.0
/// How Fast DDS is told which networks to use; for the bus's own .cpp files only.
#pragma once

#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>

#include "components/bus/participant_state.hpp"

namespace strata::bus {

/// What the user's XML profiles say, with the options on top. Throws ConfigError.
[[nodiscard]] dds::DomainParticipantQos participant_qos(const ParticipantOptions& options);

}  // namespace strata::bus
