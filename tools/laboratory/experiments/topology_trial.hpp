// SPDX-License-Identifier: Apache-2.0
/// Whether the posterior over topologies is right as often as it says.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/topology/mapper_config.hpp"
#include "core/topology/topology_filter.hpp"
#include "tools/simulate/scenario.hpp"

namespace strata::experiments {

/// Visits at most this far apart are of one place: what landmarks are to be told apart by.
inline constexpr double kOnePlace_m = 1.0;

/// Pairs of visits by the probability that they are of one place.
inline constexpr std::array<double, 13> kProbabilityBins{0.0, 0.02, 0.1, 0.2, 0.3,  0.4, 0.5,
                                                         0.6, 0.7,  0.8, 0.9, 0.98, 1.0};
struct ReliabilityBin {
  double pairs = 0.0;
  double probability = 0.0;  ///< sum over the pairs
  double one_place = 0.0;    ///< pairs that were of one place
};
struct Reliability {
  std::array<ReliabilityBin, kProbabilityBins.size() - 1> bins;

  void add(double probability, bool is_one_place);
  Reliability& operator+=(const Reliability& other);
  [[nodiscard]] double pairs() const;
  /// Share of one place less mean probability, the greatest in size over bins of so many pairs.
  [[nodiscard]] double worst_error(double least_pairs) const;
  /// The same over bins together, each by its pairs.
  [[nodiscard]] double mean_error() const;
};

/// Sums over buildings.
struct TopologyTrial {
  double buildings = 0.0;
  double visits = 0.0;
  /// Of those whose true partition is known: visits within a metre of a common third are within a
  /// metre of each other.
  double partitions = 0.0;
  double truth_first = 0.0;   ///< the true one is the likeliest
  double truth_sure = 0.0;    ///< ... and has 80% of the mass
  double truth_mass = 0.0;    ///< sum
  double largest_mass = 0.0;  ///< of the likeliest, sum
  Reliability at_end;         ///< every pair of visits, by the last posterior
  Reliability when_new;  ///< every visit with those before it, by the posterior after its update

  TopologyTrial& operator+=(const TopologyTrial& other);
};

/// Probability that visits a and b are of one landmark. O(topologies).
[[nodiscard]] double one_landmark(std::span<const topology::Hypothesis> posterior, std::size_t a,
                                  std::size_t b);

/// places_m: of all visits, by the truth. Adds what the final posterior is worth.
void judge_posterior(std::span<const Eigen::Vector2d> places_m,
                     std::span<const topology::Hypothesis> posterior, TopologyTrial& trial);

/// Drives the first day and maps it topologically, one thread.
[[nodiscard]] TopologyTrial try_topologies(const simulate::ScenarioConfig& world,
                                           std::uint64_t seed,
                                           const topology::TopologyMapperConfig& config = {});

}  // namespace strata::experiments
