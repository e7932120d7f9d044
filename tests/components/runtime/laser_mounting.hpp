// SPDX-License-Identifier: Apache-2.0
/// The mounting of a laser in the middle of its robot.
#pragma once

#include "strata_idl/tf2_msgs.h"

#include "components/convert/geometry_messages.hpp"

namespace strata::test {

inline tf2_msgs::msg::TFMessage laser_mounting() {
  tf2_msgs::msg::TFMessage message;
  message.transforms().push_back(convert::to_transform_stamped({}, Pose2{}, "base_link", "laser"));
  return message;
}

}  // namespace strata::test
