// SPDX-License-Identifier: Apache-2.0
/// The map of a robot that is mapping, for others to see while it grows.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <string>

#include "strata_idl/nav_msgs.h"
#include "strata_idl/strata_msgs.h"

#include "core/base/time.hpp"
#include "core/slam/live_map.hpp"
#include "core/slam/slam.hpp"

namespace strata::scan_matcher {

/// Publishes when there is news, at most every `every_s` of the wall clock, and so seldom that it
/// takes a twentieth of the time: a large map is published less often. Not thread-safe.
class MapPublisher {
 public:
  /// Who takes what is published.
  struct Topics {
    std::function<void(const nav_msgs::msg::OccupancyGrid&)> map;
    std::function<void(const nav_msgs::msg::OccupancyGrid&)> map_filtered;
    std::function<void(const strata_msgs::msg::ReflectionGrid&)> reflection_filtered;
    std::function<void(const nav_msgs::msg::Path&)> trajectory;
  };

  /// every_s: 0 publishes nothing. config: of the filter that makes the filtered map.
  MapPublisher(double every_s, const beam_filter::BeamFilterConfig& config, std::string map_frame,
               Topics topics);

  /// To be called with each scan and now and then. stamp: of the newest scan. Mostly O(1); when it
  /// publishes O(what is kept) and O(cells).
  void update(const slam::Slam& slam, Stamp stamp);

 private:
  using Clock = std::chrono::steady_clock;
  void publish(const slam::Slam& slam, Stamp stamp);

  double every_s_;
  std::string map_frame_;
  Topics topics_;
  slam::LiveMap map_;
  Clock::time_point due_ = Clock::now();
  std::size_t told_poses_ = 0;
};

}  // namespace strata::scan_matcher
