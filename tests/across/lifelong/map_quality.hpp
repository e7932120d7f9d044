// SPDX-License-Identifier: Apache-2.0
/// What maps are worth to a robot on a day that they were not learned on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "components/maps/maps_folder.hpp"
#include "core/geometry/pose2.hpp"
#include "core/scan/scan.hpp"
#include "tools/simulate/simulation.hpp"

namespace strata::test {

struct MapQuality {
  std::size_t scans = 0;        ///< that the maps are of
  double trajectory_m = 0.0;    ///< root mean square of their poses' error, frames aligned
  double localization_m = 0.0;  ///< mean error on the new day
  double lost = 0.0;            ///< share of the scans on the new day more than 0.5 m off
  std::size_t submaps = 0;
};

/// True poses by stamp, over all days.
using Truth = std::map<std::int64_t, Pose2>;

/// mapped: the scans that the maps were made of, in the map frame.
[[nodiscard]] MapQuality judge(const maps::Maps& maps, std::span<const PosedScan> mapped,
                               const Truth& truth, const simulate::SimulatedDay& new_day,
                               std::span<const std::uint64_t> seeds);

}  // namespace strata::test
