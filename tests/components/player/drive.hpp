// SPDX-License-Identifier: Apache-2.0
/// A log and a player of it.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "components/convert/cdr.hpp"
#include "components/log/bag.hpp"
#include "components/player/log_player.hpp"
#include "components/player/register.hpp"
#include "tests/components/runtime/host_fixture.hpp"

namespace strata::test {

/// A bag with scans, odometry and the laser's mounting: scan i at i + 1 seconds, its third range
/// 3 + i.
inline void write_drive(const std::filesystem::path& folder, int scans) {
  log::BagWriter bag(folder, log::BagStorage::kSqlite3);
  const std::size_t odometry = bag.add_topic({"/odom", "nav_msgs/msg/Odometry", "cdr", ""});
  const std::size_t scan = bag.add_topic({"/scan", "sensor_msgs/msg/LaserScan", "cdr", ""});
  const std::size_t tf = bag.add_topic({"/tf_static", "tf2_msgs/msg/TFMessage", "cdr", ""});
  std::vector<Observation> observations;
  for (int i = 0; i < scans; ++i) {
    Observation observation;
    observation.scan.stamp = Stamp{1'000'000'000LL * (i + 1)};
    observation.scan.robot_from_laser = {0.2, 0.1, 0.0};
    observation.scan.range_max_m = 10.0F;
    observation.scan.angle_increment_rad = 0.1F;
    observation.scan.ranges_m = {1.0F, 2.0F, 3.0F + static_cast<float>(i)};
    observation.odom_from_robot = {0.1 * i, 0.0, 0.0};
    observation.has_odometry = true;
    observations.push_back(observation);
  }
  const auto into = [&](std::size_t topic, const Stamp& stamp) {
    return [&bag, topic, &stamp](const auto& message) {
      bag.write(topic, stamp, convert::to_cdr(message));
    };
  };
  Stamp now;
  player::LogPlayer player(observations, {[](const auto&) {},
                                          into(tf, now),
                                          [](const auto&) {},
                                          into(odometry, now),
                                          into(scan, now),
                                          {}});
  for (std::size_t i = 0; i < observations.size(); ++i) {
    now = observations[i].scan.stamp;
    player.publish(i);
  }
  bag.close();
}

/// /player of that log; parameters: ", rate: 2" and the like.
inline std::unique_ptr<runtime::Host> play(const std::filesystem::path& log,
                                           const std::string& parameters,
                                           const std::shared_ptr<bus::Participant>& participant) {
  runtime::Registry registry;
  player::register_component(registry);
  return make_host("{type: strata::Player, name: player, parameters: {log: '" + log.string() + "'" +
                       parameters + "}}",
                   registry, participant);
}

}  // namespace strata::test
