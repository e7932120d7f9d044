// SPDX-License-Identifier: Apache-2.0
/// Experiments on localization in patch maps [stachniss2005patch, section V], each for one seed.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "tools/laboratory/experiments/simulated_maps.hpp"

namespace strata::experiments {

/// One day localized with one map model.
struct DayOutcome {
  double error_m = 0.0;          ///< mean over the scans of the paper's error
  double changed_error_m = 0.0;  ///< the same where the world may have changed
  double final_error_m = 0.0;    ///< mean over the last fifth of the scans
  double failure_rate = 0.0;     ///< share of scans further than 0.5 m from the truth
  bool is_lost = false;          ///< further than 1 m for 5 s
  int entries = 0;               ///< times that a sub-map with a known true state was entered
  int recognized = 0;            ///< of those: its probability above 0.9 within 20 weighed scans
};
using Outcomes = std::map<std::string, DayOutcome>;  ///< per model

/// Figures 3 to 5: a plain corridor, range 4 m, a box at one of three places; learned on all days
/// but the last, localized on the last. Models: occupancy, filtered, patch_paper, patch_shared,
/// patch; own_day is the filtered map of that last day itself, which no memory can beat.
/// Changed: x in [11, 25] m. scenario: corridor_box.yaml, with a scanner of a beam a degree: one of
/// 180 degrees does not see the box any more once the robot is beside it, and what is left of the
/// plain walls is odometry's.
[[nodiscard]] Outcomes box_in_corridor(const std::string& scenario, std::uint64_t seed,
                                       int field_of_view_deg,
                                       const std::vector<std::string>& models);

/// Figures 6 and 7: a global start where a door decides between two places that look alike.
/// Learned on one day with the door closed and one with it open; models `closed` and `open` know
/// one day each. The test is driven with the door open or closed. scenario: side_door.yaml.
[[nodiscard]] Outcomes global_start(const std::string& scenario, std::uint64_t seed, bool is_open,
                                    const std::vector<std::string>& models);

/// The drive of global_start, twice as long: its door is closed first, and open from the middle of
/// the scans on.
[[nodiscard]] simulate::Simulation drive_while_door_opens(const std::string& scenario,
                                                          std::uint64_t seed);

/// The mean error over the last fifth of the scans of each phase [m].
struct TwoPhases {
  double closed_m = 0.0;
  double open_m = 0.0;
};
/// The same in one run: the start is with the door closed, and half-way through it opens.
[[nodiscard]] std::map<std::string, TwoPhases> door_opens(const std::string& scenario,
                                                          std::uint64_t seed,
                                                          const std::vector<std::string>& models);

/// A random office: learned on three days, localized on the fourth.
[[nodiscard]] Outcomes office_day(std::uint64_t office, std::uint64_t seed,
                                  const std::vector<std::string>& models);

}  // namespace strata::experiments
