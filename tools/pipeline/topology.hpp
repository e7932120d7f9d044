// SPDX-License-Identifier: Apache-2.0
/// From one run to its topologies and the metric map of the likeliest one.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/progress.hpp"
#include "core/scan/scan.hpp"
#include "core/topology/mapper_config.hpp"
#include "core/topology/topology_map.hpp"

namespace strata::pipeline {

struct TopologyMap : topology::TopologyMap {
  std::vector<double> update_ms;  ///< wall time of each visit's update
};

/// observations: one run in time order. landmark_times_s: seconds from the first scan; replaces
/// detection. given: empty, or one an observation, used instead of odometry and scan matching where
/// it is known. The map frame is that of the first scan's odometry. Deterministic for a seed at any
/// number of threads, but update_ms. Throws Cancelled, and InputError without two landmarks.
[[nodiscard]] TopologyMap map_topology(const std::vector<Observation>& observations,
                                       const std::vector<std::optional<Pose2>>& given,
                                       std::optional<std::span<const double>> landmark_times_s,
                                       const topology::TopologyMapperConfig& config,
                                       std::uint64_t seed, int threads, Progress* progress);

/// Pairs of visits whose places are known from a true trajectory, as far as that is precise.
struct TopologyAgreement {
  std::size_t near = 0;            ///< places surely within the distance of each other ...
  std::size_t near_merged = 0;     ///< ... that the topology holds to be one landmark
  std::size_t unclear = 0;         ///< places that may be within it or not ...
  std::size_t unclear_merged = 0;  ///< ... that it takes for one
  std::size_t between = 0;         ///< places surely further apart, but not twice as far ...
  std::size_t between_merged = 0;  ///< ... that it takes for one ...
  /// ... that must be one where all are that may be within it: others link them.
  std::size_t between_chained = 0;
  std::size_t far = 0;         ///< places at least twice that far apart ...
  std::size_t far_merged = 0;  ///< ... that it takes for one, wrongly
};
/// Of all pairs of visits whose scans have a true pose. truths: one an observation, in any frame;
/// precision_m: how well they tell the distance of two places.
[[nodiscard]] TopologyAgreement agreement(const TopologyMap& result,
                                          const topology::Hypothesis& hypothesis,
                                          const std::vector<Observation>& observations,
                                          const std::vector<std::optional<Pose2>>& truths,
                                          double near_m, double precision_m = 0.0);

/// Times in seconds from the first scan, one a line; `#` begins a comment. Throws InputError with
/// file and line.
[[nodiscard]] std::vector<double> read_landmark_times(const std::string& path);

}  // namespace strata::pipeline
