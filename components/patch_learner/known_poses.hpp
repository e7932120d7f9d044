// SPDX-License-Identifier: Apache-2.0
/// Where scans are known to have been taken, as a mapper tells it.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "strata_idl/nav_msgs.h"

#include "core/base/time.hpp"
#include "core/geometry/pose2.hpp"

namespace strata::patch_learner {

class KnownPoses {
 public:
  /// Poses that are not finite, and those of which several have one stamp (a clock that was set
  /// back), are not known. O(n log n).
  explicit KnownPoses(const nav_msgs::msg::Path& path);
  /// Of the scan with that stamp. O(log n).
  [[nodiscard]] std::optional<Pose2> at(Stamp stamp) const;

 private:
  std::vector<std::pair<Stamp, Pose2>> poses_;  ///< by stamp
};

}  // namespace strata::patch_learner
