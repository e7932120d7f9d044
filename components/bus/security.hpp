// SPDX-License-Identifier: Apache-2.0
/// DDS security as ROS 2 turns it on: which files a participant shows; for the bus's own .cpp files
/// only.
#pragma once

#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>

#include "components/bus/participant_state.hpp"

namespace strata::bus {

/// Adds the plugins and files of the enclave that `options` names, after reading them. Returns
/// false, and adds nothing, where security is off, or permissive and the enclave not there. Throws
/// InputError, at the file, for an enclave that is missing though it is enforced, or is not good:
/// Fast DDS itself says little of why it refuses one.
[[nodiscard]] bool secure(const ParticipantOptions& options, dds::DomainParticipantQos& qos);

}  // namespace strata::bus
