// SPDX-License-Identifier: Apache-2.0
/// Scans that can be told apart, and those that a bag holds.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "strata_idl/sensor_msgs.h"

#include "components/convert/cdr.hpp"
#include "components/log/bag.hpp"

namespace strata::incident_recorder {

inline sensor_msgs::msg::LaserScan numbered(int number) {
  sensor_msgs::msg::LaserScan scan;
  scan.header().stamp().sec(number);
  scan.ranges().assign(100, static_cast<float>(number));
  return scan;
}

/// Numbers of the scans of a bag, by topic.
inline std::map<std::string, std::vector<int>> scans_in(const std::filesystem::path& folder) {
  const auto reader = log::BagReader::open(folder);
  std::map<std::string, std::vector<int>> numbers;
  for (log::BagMessage message; reader->next(message);) {
    const log::BagTopic& topic = reader->topics()[message.topic];
    if (topic.type != "sensor_msgs/msg/LaserScan") continue;
    const auto scan = convert::from_cdr<sensor_msgs::msg::LaserScan>(message.data, topic.name);
    numbers[topic.name].push_back(scan.header().stamp().sec());
  }
  return numbers;
}

}  // namespace strata::incident_recorder
