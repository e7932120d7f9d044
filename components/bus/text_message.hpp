// SPDX-License-Identifier: Apache-2.0
/// std_msgs/String as a message of topics.
#pragma once

#include "strata_idl/std_msgs.h"

#include "components/bus/message_types.hpp"

namespace strata::bus {

template <>
struct MessageType<std_msgs::msg::String> {
  static constexpr const char* name = "std_msgs/msg/String";
};

}  // namespace strata::bus
