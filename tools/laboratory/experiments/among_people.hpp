// SPDX-License-Identifier: Apache-2.0
/// SLAM with its beam filter in corridors full of people, against the simulator's truth.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>

#include "tools/shards/units.hpp"
#include "tools/simulate/simulation.hpp"

namespace strata::experiments {

struct PeopleOutcome {
  std::size_t person_beams = 0;
  double precision = 0.0;
  double recall = 0.0;
  std::size_t spurious_raw = 0;  ///< cells that reflect, in which only people were hit
  std::size_t spurious_filtered = 0;
  std::size_t obstacles_raw = 0;  ///< those of them that count as obstacles
  std::size_t obstacles_filtered = 0;
  std::size_t wall_cells = 0;  ///< occupied cells of the raw map in which nobody was hit
  double walls_lost = 0.0;     ///< share of them that the filtered map has free
  double pose_error_m = 0.0;
};

/// The scenario with so many of its people. Throws InputError.
[[nodiscard]] simulate::Simulation drive_among(const std::filesystem::path& scenario,
                                               std::size_t people, std::uint64_t seed);

/// SLAM on such a drive, and what became of its beams and its map.
[[nodiscard]] PeopleOutcome learn_among(const std::filesystem::path& scenario, std::size_t people,
                                        std::uint64_t seed);

/// Prints what learn_among says of corridor_people.yaml, a line a seed, and the sums.
void report_people(const std::filesystem::path& scenarios, std::uint64_t first, int seeds,
                   shards::Units& units);

/// Prints pose errors with the beam filter and without, seed by seed and paired.
void report_filter_against_none(const std::filesystem::path& scenarios, std::uint64_t first,
                                int seeds, shards::Units& units);

}  // namespace strata::experiments
