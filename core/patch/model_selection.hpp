// SPDX-License-Identifier: Apache-2.0
/// How many configurations a sub-map has: fuzzy k-means for growing k, scored by BIC
/// [stachniss2005patch eq. (4)] (docs/theory/patch_maps.md, "Model selection").
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "core/base/config.hpp"
#include "core/patch/fuzzy_kmeans.hpp"

namespace strata::patch {

/// What |theta| of the criterion counts.
enum class ThetaMode : std::uint8_t {
  kCells,     ///< free parameters: k * dimension + k - 1
  kClusters,  ///< k, the paper's wording; splits noisy maps too often
};

}  // namespace strata::patch

template <>
struct strata::EnumNames<strata::patch::ThetaMode> {
  static constexpr std::array<std::pair<patch::ThetaMode, const char*>, 2> values{
      {{patch::ThetaMode::kCells, "cells"}, {patch::ThetaMode::kClusters, "clusters"}}};
};

namespace strata::patch {

struct ModelSelectionConfig {
  FuzzyKMeansConfig fuzzy;
  double cell_stddev = 0.38;
  ThetaMode theta_mode = ThetaMode::kCells;
  int patience = 1;
  int min_features = 4;

  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.group("fuzzy", c.fuzzy, "fuzzy k-means");
    v.field("cell_stddev", c.cell_stddev,
            {.doc = "spread of a cell's reflection within one configuration; estimating it instead "
                    "would split every map into too many",
             .unit = "1",
             .min = 0.01});
    v.field("theta_mode", c.theta_mode,
            {.doc = "cells: count every cell of every configuration as a parameter; clusters: only "
                    "the configurations, as the paper says",
             .preset = {"paper-patch", "clusters"}});
    v.field("patience", c.patience,
            {.doc = "stop after this many decreases of the criterion in a row", .min = 1});
    v.field("min_features", c.min_features,
            {.doc = "with fewer contradictory cells there is one configuration",
             .unit = "cells",
             .min = 1});
  }
};

struct Clustering {
  FuzzyClusters clusters;         ///< the model with the greatest criterion
  std::vector<double> criterion;  ///< BIC for k = 1, 2, ... as far as tried [nats]
  [[nodiscard]] std::size_t k() const { return clusters.centroids.size(); }
};

/// ln P(a_i | theta) = ln sum_c pi_c prod_j N(a_ij; mu_cj, cell_stddev) over the entries known in
/// both, pi_c the mean membership; per vector [nats]. Unknown entries are marginalized. O(n k dim).
[[nodiscard]] std::vector<double> log_likelihoods(const VectorSet& vectors,
                                                  const FuzzyClusters& clusters,
                                                  double cell_stddev);

/// exp(-sum_j (a_ij - mu_cj)^2 / 2 cell_stddev^2) over the entries known in both, for each centre
/// and vector, over the sum of each vector: how likely it is of each cluster, where none is more
/// usual. Sharper than memberships, which are no probabilities. O(n k dim).
[[nodiscard]] std::vector<std::vector<double>> likelihood_shares(
    const VectorSet& vectors, const std::vector<Centroid>& centroids, double cell_stddev);

/// sum_i ln P(a_i | theta) - (k - 1) / 2 ln n - dimension / 2 sum_c ln(1 + n_c), n_c the vectors of
/// cluster c: its centre is estimated from those alone, so the Laplace approximation that BIC comes
/// from charges ln n_c for each entry, not ln n; with ln n a state that two of 34 vectors show is
/// not worth a cluster. theta_mode clusters: - k / 2 ln n, the paper's wording.
[[nodiscard]] double bayesian_information(const VectorSet& vectors, const FuzzyClusters& clusters,
                                          const ModelSelectionConfig& config);

/// Starts with one cluster at the mean; each step adds a cluster at the vector that the model
/// explains worst and re-runs fuzzy k-means from there; stops at the first decrease of the
/// criterion
/// (`patience` in a row) or at k = n. "Explains worst" is the least likelihood relative to a
/// perfect fit, so that a vector with few known entries, whose density has fewer factors, is not
/// taken for an unlikely one; the entries it does not know start at those of its nearest centre.
/// each: is told of every model tried, in order. Requires at least one vector. O(k^2 sweeps n
/// dimension).
[[nodiscard]] Clustering select_clusters(
    const VectorSet& vectors, const ModelSelectionConfig& config,
    const std::function<void(const FuzzyClusters&)>& each = nullptr);

}  // namespace strata::patch
