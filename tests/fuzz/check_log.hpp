// SPDX-License-Identifier: Apache-2.0
/// What a log that was read promises to everything behind it.
#pragma once

#include "components/log/log_reader.hpp"

namespace strata::fuzz {

inline void check_log(const log::LogContent& content) {
  for (std::size_t i = 0; i < content.observations.size(); ++i) {
    const Observation& observation = content.observations[i];
    const bool sorted = i == 0 || content.observations[i - 1].scan.stamp <= observation.scan.stamp;
    if (!sorted || observation.scan.size() == 0 || !is_finite(observation.odom_from_robot) ||
        !is_finite(observation.scan.robot_from_laser)) {
      __builtin_trap();
    }
    (void)count_beams(observation.scan);
  }
}

}  // namespace strata::fuzz
