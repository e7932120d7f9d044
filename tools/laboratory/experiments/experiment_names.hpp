// SPDX-License-Identifier: Apache-2.0
/// Which experiments `strata-experiments` knows.
#pragma once

#include <iterator>
#include <sstream>
#include <string>
#include <vector>

namespace strata::experiments {

[[nodiscard]] inline std::vector<std::string> experiment_names() {
  constexpr const char* kNames =
      "three_doors local_maps few_visits static_offices box_in_corridor global_start offices "
      "refined_poses year place decoders wean verdicts score people filter few_beams single_scan "
      "standing_robot standing_robot_online door_times starts half_known folded_maps topologies "
      "kidnapped floor_plans lift_rides gates glass";
  std::istringstream in(kNames);
  return {std::istream_iterator<std::string>(in), {}};
}

}  // namespace strata::experiments
