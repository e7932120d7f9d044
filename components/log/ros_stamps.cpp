// SPDX-License-Identifier: Apache-2.0
#include "components/log/ros_stamps.hpp"

#include <cstdint>

#include "components/log/text.hpp"
#include "core/base/error.hpp"

namespace strata::log {
namespace {

constexpr std::int64_t kNsPerS = 1'000'000'000;
constexpr std::int64_t kEnd_s = std::int64_t{1} << 31U;

void require(Stamp stamp, const std::string& place, const char* what, std::size_t index) {
  if (is_ros_stamp(stamp)) return;
  require_ros_stamp(stamp, place + ": " + what + " " + std::to_string(index + 1));
}

}  // namespace

bool is_ros_stamp(Stamp stamp) {
  return stamp.ns >= -kEnd_s * kNsPerS && stamp.ns < kEnd_s * kNsPerS;
}

void require_ros_stamp(Stamp stamp, const std::string& place) {
  if (is_ros_stamp(stamp)) return;
  throw InputError(place,
                   "its stamp " + format_stamp(stamp) +
                       " s does not fit into the messages of ROS 2, "
                       "which end at 2147483647 s",
                   "correct the stamps, or count them from the start of the log");
}

void require_ros_stamps(std::span<const Observation> observations,
                        std::span<const OdometrySample> odometry, const std::string& place) {
  for (std::size_t i = 0; i < observations.size(); ++i) {
    require(observations[i].scan.stamp, place, "scan", i);
  }
  for (std::size_t i = 0; i < odometry.size(); ++i) {
    require(odometry[i].stamp, place, "odometry", i);
  }
}

}  // namespace strata::log
