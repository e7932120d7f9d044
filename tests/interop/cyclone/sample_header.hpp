// SPDX-License-Identifier: Apache-2.0
/// The header of every sample that has one.
#pragma once

#include <string>

#include "components/bus/message_types.hpp"

namespace strata::test {

inline std_msgs::msg::Header header(const std::string& frame) {
  std_msgs::msg::Header result;
  result.stamp().sec(1700000000);
  result.stamp().nanosec(123456789);
  result.frame_id(frame);
  return result;
}

}  // namespace strata::test
