// SPDX-License-Identifier: Apache-2.0
/// What components have in common: one setting, whoever has it, and usually set for all at once.
#pragma once

#include "core/base/config.hpp"

namespace strata::runtime {

inline constexpr FieldInfo kMapFrame{
    .doc = "frame of poses and maps, in and out; where clouds are mapped, tf must tie it to theirs",
    .when = "your map frame has another name, or several robots have a map each"};
inline constexpr FieldInfo kOdometryFrame{.doc = "child of map_frame in /tf",
                                          .when = "your odometry frame has another name"};
inline constexpr FieldInfo kPublishTf{
    .doc = "broadcast map_frame -> odometry_frame",
    .when = "somebody else broadcasts it, as a localizer beside a scan matcher: one only may"};

}  // namespace strata::runtime
