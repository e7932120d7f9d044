// SPDX-License-Identifier: Apache-2.0
/// What the localizer says of itself where the world has changed, and where it was kidnapped.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "tools/laboratory/experiments/verdict_worlds.hpp"

namespace strata::experiments {

/// What was said in weighed scans. Doubtful: fewer beams are inliers of the map than lost_share of
/// the usual, which alone is not the verdict "lost".
struct VerdictCounts {
  std::size_t scans = 0;  ///< tracked, within 0.5 m of the truth
  std::size_t doubtful = 0;
  std::size_t lost = 0;
  std::size_t kidnapped = 0;  ///< times that the robot was kidnapped, and stayed wrong for a while
  std::size_t doubtful_soon = 0;  ///< of those: within 20 weighed scans
  std::size_t lost_soon = 0;
  std::size_t doubtful_ever = 0;  ///< ... before the drive ended or the pose was right again
  std::size_t lost_ever = 0;

  VerdictCounts& operator+=(const VerdictCounts& other);
};

/// Tracks the whole drive, and carries the robot away `times` times: each time it tracks 150
/// scans from the truth on and then sees, without odometry telling, what was seen elsewhere in the
/// drive. No recovery. model: "patch", "filtered", or "field" for end points in the filtered map.
[[nodiscard]] VerdictCounts count_verdicts(const VerdictWorld& world, const std::string& model,
                                           int times, std::uint64_t seed);

/// Prints the counts of the logs, of the three runs of Wean Hall each in maps of the others
/// (where `runs` is not empty), and of the ten random offices from number `seed` on.
void report_verdicts(const std::filesystem::path& runs, const std::vector<std::string>& logs,
                     const std::vector<std::string>& poses, std::uint64_t seed);

}  // namespace strata::experiments
