// SPDX-License-Identifier: Apache-2.0
/// A localizer's particle cloud off the wire, as the errors are computed from it.
#pragma once

#include "strata_idl/nav2_msgs.h"

#include "core/geometry/pose2.hpp"
#include "core/localization/particle_set.hpp"
#include "tools/pipeline/localization_metrics.hpp"

namespace strata::tools {

/// Poses and weights; the patch state does not travel.
[[nodiscard]] localization::ParticleSet from_message(const nav2_msgs::msg::ParticleCloud& cloud);

/// The paper's error of a scan: the weighted mean distance of all particles from the truth.
[[nodiscard]] pipeline::ScanError error_of(const nav2_msgs::msg::ParticleCloud& cloud,
                                           const Pose2& truth);

}  // namespace strata::tools
