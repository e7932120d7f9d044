// SPDX-License-Identifier: Apache-2.0
#include "components/runtime/resume.hpp"

namespace strata::runtime {
namespace {

bool is_recent(const KeptMoment& kept, const Observation& first,
               const DeadReckoningConfig& config) {
  const double since_s = (first.scan.stamp - kept.stamp).seconds();
  return kept.has_odometry && since_s >= 0.0 && since_s <= config.dead_reckoning_s;
}

}  // namespace

bool is_dead_reckoned(const KeptMoment& kept, const Observation& first,
                      const DeadReckoningConfig& config) {
  return first.has_odometry && is_recent(kept, first, config);
}

bool needs_odometry(const KeptMoment& kept, const Observation& first,
                    const DeadReckoningConfig& config) {
  return !first.has_odometry && is_recent(kept, first, config);
}

}  // namespace strata::runtime
