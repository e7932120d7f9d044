// SPDX-License-Identifier: Apache-2.0
/// Which of two poses of one scan is the better: by its beams, and by odometry.
#pragma once

#include "core/geometry/pose2_gaussian.hpp"
#include "core/registration/scan_matcher.hpp"
#include "core/scan/endpoints.hpp"
#include "core/tracking/surface_map.hpp"

namespace strata::slam {

/// By how much likelier the beams are at `other` than at `own` [nats, positive: likelier], of those
/// whose ends the map knows from both. The others speak for neither: into what nobody has seen yet
/// a robot that goes on looks more than one that is held back, and each of those beams would count
/// against it. What ends in the unknown behind a surface is known not to fit. Where they are fewer
/// than a tenth, all are asked. Poses are of the robot in the map's frame. O(length of all beams).
[[nodiscard]] double likelier_by(const Pose2& other, const Pose2& own, const Endpoints& endpoints,
                                 const SurfaceMap& map, const registration::MatchConfig& config);

/// By how much odder `other` is than `own` by odometry's guess [nats], whose errors have long
/// tails: 6 nats at most, of so many steps one may be wrong as a whole. Where the two lie so far
/// apart that they may be look-alikes, odometry that agreed with the matches lately may object the
/// more. doubt: of odometry, 0 (excluded) to 1.
[[nodiscard]] double odder_by(const Pose2& other, const Pose2& own, const Pose2Gaussian& guess,
                              double doubt);

}  // namespace strata::slam
