// SPDX-License-Identifier: Apache-2.0
/// Where a log's messages go in lockstep.
#pragma once

#include <string>

#include "components/player/log_player.hpp"
#include "components/runtime/lockstep_coordinator.hpp"

namespace strata::player {

/// The topics of a robot in the namespace `scope`, advertised at the coordinator; with_poses: given
/// poses too.
[[nodiscard]] Outputs conducted_outputs(runtime::LockstepCoordinator& coordinator,
                                        const std::string& scope = "", bool with_poses = false);

}  // namespace strata::player
