// SPDX-License-Identifier: Apache-2.0
/// A scenario's first day to learn from, and its second to localize on.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tools/simulate/simulation.hpp"

namespace strata::test {

struct TwoDays {
  std::vector<Observation> first;
  std::vector<std::optional<Pose2>> first_poses;  ///< map_from_robot at each
  std::vector<Observation> second;
  std::vector<Pose2> second_poses;
};

inline TwoDays two_days(const std::string& scenario, std::uint64_t seed) {
  const simulate::Simulation simulation =
      simulate::simulate(simulate::load_scenario(scenario), seed);
  TwoDays days;
  for (const auto& scan : simulation.days[0].scans) {
    days.first.push_back(scan.observation);
    days.first_poses.emplace_back(scan.map_from_robot);
  }
  for (const auto& scan : simulation.days[1].scans) {
    days.second.push_back(scan.observation);
    days.second_poses.push_back(scan.map_from_robot);
  }
  return days;
}

}  // namespace strata::test
