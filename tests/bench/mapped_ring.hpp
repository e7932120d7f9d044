// SPDX-License-Identifier: Apache-2.0
/// Where benchmarks' robots drive, with maps of it.
#pragma once

#include <string>
#include <vector>

#include "components/maps/maps_folder.hpp"
#include "core/slam/slam.hpp"
#include "tests/bench/ring_drive.hpp"
#include "tests/support/test_data.hpp"

namespace strata::bench {

inline constexpr std::size_t kMappedScans = 1'000;

/// A drive, and the maps of it that `strata learn` would write.
struct World {
  test::TemporaryDirectory folder;
  std::vector<Observation> log = ring_log();
  World() {
    log.resize(kMappedScans);
    slam::Slam slam(slam::SlamConfig{});
    for (const Observation& observation : log) (void)slam.add(observation);
    maps::write_grid_maps(folder.path(), slam.finish());
  }
  /// The entry of a composition.
  [[nodiscard]] std::string localizer(const std::string& ros_namespace = "/") const {
    return "{type: strata::Localizer, name: localizer, namespace: " + ros_namespace +
           ", parameters: {maps: " + folder.path().string() + ", model: filtered, start: {pose: [" +
           std::to_string(log[0].odom_from_robot.x) + ", " +
           std::to_string(log[0].odom_from_robot.y) + ", " +
           std::to_string(log[0].odom_from_robot.theta) + "]}}}";
  }
};

inline const World& world() {
  static const World made;
  return made;
}

}  // namespace strata::bench
