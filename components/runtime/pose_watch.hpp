// SPDX-License-Identifier: Apache-2.0
/// Doubts a pose that lies far from the one before it: one broken message must not make a map grow
/// over a whole town, which takes all memory.
#pragma once

#include <optional>
#include <string>

#include "core/base/error.hpp"
#include "core/geometry/pose2.hpp"

namespace strata::runtime {

class PoseWatch {
 public:
  /// Further than that no robot gets from one scan to the next.
  static constexpr double kFar_m = 100.0;

  /// Throws InputError(place, ...) for a pose further than kFar_m from the last one that was
  /// believed. The second of two far ones that agree is believed: the robot was carried.
  void require(const Pose2& map_from_robot, const std::string& place) {
    const Eigen::Vector2d at = map_from_robot.translation();
    const bool is_far = last_ && !((at - *last_).norm() <= kFar_m);
    const bool agrees = doubted_ && (at - *doubted_).norm() <= kFar_m;
    doubted_.reset();
    if (is_far && !agrees) {
      doubted_ = at;
      throw InputError(place, "a pose lies further than 100 m from the one before",
                       "see what publishes it; where the robot was carried, the next is taken");
    }
    last_ = at;
  }

 private:
  std::optional<Eigen::Vector2d> last_;
  std::optional<Eigen::Vector2d> doubted_;
};

}  // namespace strata::runtime
