// SPDX-License-Identifier: Apache-2.0
/// SLAM with scanners of a few beams all round, against odometry alone.
#pragma once

#include <cstdint>
#include <filesystem>

#include "tools/shards/units.hpp"

namespace strata::experiments {

/// Mean errors of the poses [m], and in how many runs SLAM's are the larger ones.
struct FewBeamsErrors {
  double slam_m = 0.0;
  double odometry_m = 0.0;
  int worse = 0;
};

/// The first day of the scenario with nobody about, over the seeds first to last. Throws
/// InputError.
[[nodiscard]] FewBeamsErrors drive_with_few_beams(const std::filesystem::path& scenario, int beams,
                                                  std::uint64_t first, std::uint64_t last,
                                                  shards::Units& units);

/// Prints a line for each world and number of beams.
void report_few_beams(const std::filesystem::path& scenarios, std::uint64_t first, int seeds,
                      shards::Units& units);

}  // namespace strata::experiments
