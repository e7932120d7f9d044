// SPDX-License-Identifier: Apache-2.0
/// Where the walking people of a scenario are, as the circles of their legs.
#pragma once

#include <cstdint>
#include <vector>

#include "tools/simulate/scenario.hpp"
#include "tools/simulate/world.hpp"

namespace strata::simulate {

/// The people of one day. Their walks are functions of time, but for the room they give the robot.
class People {
 public:
  /// Draws where on their way they start and how fast they walk (within 20%).
  People(const ScenarioConfig& scenario, std::uint64_t seed, int day);

  /// Two circles a person at this time of the day. Whoever would be nearer to the robot than its
  /// personal space stands aside, straight away from it.
  [[nodiscard]] std::vector<Circle> legs_at(double time_s, const Eigen::Vector2d& robot) const;

 private:
  struct Walk {
    PersonConfig person;
    std::vector<double> arc_m;  ///< length of the path up to each point
    double offset_s = 0.0;
    double speed_mps = 0.0;
  };
  std::vector<Walk> walks_;
  double personal_space_m_;
};

}  // namespace strata::simulate
