// SPDX-License-Identifier: Apache-2.0
/// How many messages of a topic are meant.
#pragma once

#include <cstdint>
#include <string>

#include "strata_idl/strata_msgs.h"

namespace strata::runtime {

inline strata_msgs::msg::TopicCount topic_count(const std::string& topic, std::uint64_t count) {
  strata_msgs::msg::TopicCount result;
  result.topic(topic);
  result.count(count);
  return result;
}

}  // namespace strata::runtime
