// SPDX-License-Identifier: Apache-2.0
#include "components/patch_learner/known_poses.hpp"

#include <algorithm>
#include <iterator>

#include "components/convert/geometry_messages.hpp"

namespace strata::patch_learner {

KnownPoses::KnownPoses(const nav_msgs::msg::Path& path) {
  poses_.reserve(path.poses().size());
  for (const auto& pose : path.poses()) {
    poses_.emplace_back(convert::from_message(pose.header().stamp()),
                        planar(convert::from_message(pose.pose())));
  }
  std::stable_sort(poses_.begin(), poses_.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
}

std::optional<Pose2> KnownPoses::at(Stamp stamp) const {
  const auto first =
      std::lower_bound(poses_.begin(), poses_.end(), stamp,
                       [](const auto& pose, Stamp wanted) { return pose.first < wanted; });
  if (first == poses_.end() || first->first != stamp || !is_finite(first->second)) {
    return std::nullopt;
  }
  const auto next = std::next(first);
  if (next != poses_.end() && next->first == stamp) return std::nullopt;
  return first->second;
}

}  // namespace strata::patch_learner
