// SPDX-License-Identifier: Apache-2.0
/// Looks and listens on a domain.
#pragma once

#include <functional>
#include <memory>

#include "components/bus/participant.hpp"
#include "tools/doctor/examination.hpp"

namespace strata::doctor {

/// Joins nothing, disturbs nothing but by reading: subscribes, best effort, to every ROS 2 topic
/// that is published, and once more to latched ones for what was published before, until `wait`
/// says enough. wait: called again and again; sleeps for up to so
/// many seconds and returns whether to go on.
[[nodiscard]] Observed listen(const std::shared_ptr<bus::Participant>& participant,
                              const std::function<bool(double)>& wait);

}  // namespace strata::doctor
