// SPDX-License-Identifier: Apache-2.0
/// Which topologies and which labels are followed to the next visit [ranganathan2006rao, eqs. (4)
/// and (16)] (docs/theory/topological_mapping.md, "Proposal and weight").
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/topology/config.hpp"
#include "core/topology/expansion.hpp"
#include "core/topology/topology_filter.hpp"

namespace strata::topology {

/// What random numbers depend on.
struct DrawKey {
  std::uint64_t seed = 1;
  std::size_t visits = 0;  ///< so far, with the newest
};

/// Of each hypothesis the particles that follow it, each as a place in [0, 1) from which its label
/// is drawn. One each when the best are kept exactly; else config.particles in all, drawn by
/// probability. Parents and labels are drawn at once by one comb of evenly spaced places
/// (systematic): each particle's law is that of drawing one after the other, as the paper does, and
/// the counts scatter less. O(particles).
[[nodiscard]] std::vector<std::vector<double>> choose_parents(
    const std::vector<Hypothesis>& posterior, const TopologyConfig& config, const DrawKey& key);

/// One label to follow: the parent's share of particles, and by what looking multiplies it.
struct Choice {
  std::size_t child = 0;
  double log_factor = 0.0;  ///< weight before looking, less ln Z(L + j; odometry)
};

/// The labels that a parent's particles draw from their places (or all of them, when the best are
/// kept exactly), each with the logarithm of its weight less ln Z(L + j; odometry).
[[nodiscard]] std::vector<Choice> choose_children(const Hypothesis& parent,
                                                  const Children& children,
                                                  const std::vector<double>& places,
                                                  const TopologyConfig& config);

/// The topologies that come of holding two landmarks of this one, whose first visits it puts within
/// four standard deviations of a revisit, for one. Canonical. O(landmarks^2).
[[nodiscard]] std::vector<Labels> mergers(const Hypothesis& hypothesis,
                                          const LocationPriorConfig& config);

/// The topologies that come of one visit belonging elsewhere: to the landmark that now lies
/// nearest, if that is another one, or to one of its own, if it lies more than two standard
/// deviations from its landmark. Canonical. O(visits x landmarks).
[[nodiscard]] std::vector<Labels> moved_visits(const Hypothesis& hypothesis,
                                               const LocationPriorConfig& config);

}  // namespace strata::topology
