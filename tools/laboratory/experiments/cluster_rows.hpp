// SPDX-License-Identifier: Apache-2.0
/// How the local maps of one changeable area become clusters, one cluster more a step: the rows of
/// figure 1.18 of [stachniss2003chapter].
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/patch/model_selection.hpp"
#include "core/patch/patch_map.hpp"
#include "tools/laboratory/experiments/simulated_maps.hpp"

namespace strata::experiments {

struct ClusterRows {
  ReflectionGrid base;  ///< the static map
  patch::Submap submap;
  std::vector<Cell> cells;          ///< what the entries of a vector are of
  patch::VectorSet local_maps;      ///< a row a local map
  std::vector<std::size_t> states;  ///< what was true during each
  /// One, two, ... clusters, as far as tried: the last has one too many.
  std::vector<patch::FuzzyClusters> rows;
  std::vector<double> criterion;  ///< of each [nats]

  /// The row with the greatest criterion.
  [[nodiscard]] std::size_t best() const;
  /// Local maps that belong most to a cluster to which most of those of their own state belong
  /// most, and to which no other state does.
  [[nodiscard]] std::size_t rightly_clustered() const;
  /// Whether the row after the best has all that is in its newest cluster from one state, which has
  /// another cluster too; not without such a row.
  [[nodiscard]] bool splits_a_state() const;
  /// Mean over the local maps of their greatest membership in the best row.
  [[nodiscard]] double mean_membership() const;
  /// How near the two nearest centres of a row are to each other: root of the squared distance over
  /// the cells that both know. Infinite for one centre.
  [[nodiscard]] double nearest_centres(std::size_t row) const;
};

/// Of the sub-map that covers the scenario's only object, at poses 2 cm off; nothing where it was
/// not found. scenario: four_states.yaml.
[[nodiscard]] std::optional<ClusterRows> cluster_rows(const std::string& scenario,
                                                      std::uint64_t seed);

/// A local map, or a centre, over the static map.
[[nodiscard]] ReflectionGrid over_base(const ClusterRows& rows, std::span<const double> entries);

}  // namespace strata::experiments
