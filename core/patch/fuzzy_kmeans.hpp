// SPDX-License-Identifier: Apache-2.0
/// Fuzzy k-means over vectors of reflection probabilities with unknown entries
/// [stachniss2005patch, "Learning Environmental Configurations"; duda2001pattern, as the paper
/// cites it] (docs/theory/patch_maps.md, "Fuzzy k-means").
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace strata::patch {

/// n vectors of one dimension, row by row; NaN marks an unknown entry (xi).
struct VectorSet {
  std::size_t dimension = 0;
  std::vector<float> values;

  [[nodiscard]] std::size_t size() const { return dimension == 0 ? 0 : values.size() / dimension; }
  [[nodiscard]] std::span<const float> row(std::size_t i) const {
    return std::span(values).subspan(i * dimension, dimension);
  }
};

/// One cluster centre; NaN where no member knows the entry.
using Centroid = std::vector<double>;

/// (1.18): the sum over entries of (a - b)^2 where both are known, epsilon where one is, 0 where
/// none is. The paper prints (a - b) without a square, whose terms cancel: a moved box would have
/// distance 0. The square makes the weighted mean the exact minimizer. O(dimension).
[[nodiscard]] double squared_distance(std::span<const float> a, std::span<const double> b,
                                      double epsilon);

struct FuzzyKMeansConfig {
  double fuzziness = 1.5;
  double epsilon = 1e-3;
  double tolerance = 1e-4;
  int max_sweeps = 100;

  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("fuzziness", c.fuzziness,
            {.doc = "exponent b of the memberships; towards 1 they become hard",
             .unit = "1",
             .min = 1.01,
             .max = 5.0});
    v.field("epsilon", c.epsilon,
            {.doc = "squared distance of an unknown to a known cell", .unit = "1", .min = 0.0});
    v.field("tolerance", c.tolerance,
            {.doc = "stop when no centre moves by more in any cell", .unit = "1", .min = 0.0});
    v.field("max_sweeps", c.max_sweeps, {.doc = "stop after this many sweeps", .min = 1});
  }
};

struct FuzzyClusters {
  std::vector<Centroid> centroids;
  /// Row i: memberships of vector i in each cluster; each row sums to 1.
  std::vector<std::vector<double>> memberships;
  /// J = sum u^b d^2 after each sweep; never rises once the known entries of the centres settle.
  std::vector<double> objective;
  bool converged = false;
};

/// Alternates u_ic = d_ic^(-2/(b-1)) / sum_c' d_ic'^(-2/(b-1)) (in logarithms, d^2 at least 1e-9)
/// and mu_cj = sum_i u^b a_ij / sum_i u^b over the i that know j, from the given centres. Requires
/// at least one vector and one centre, all of one dimension. O(sweeps x n x k x dimension).
[[nodiscard]] FuzzyClusters fuzzy_kmeans(const VectorSet& vectors, std::vector<Centroid> centroids,
                                         const FuzzyKMeansConfig& config);

/// The memberships that the given centres imply (the first half of a sweep). O(n k dimension).
[[nodiscard]] std::vector<std::vector<double>> memberships_of(
    const VectorSet& vectors, const std::vector<Centroid>& centroids,
    const FuzzyKMeansConfig& config);

/// The mean of all vectors, per entry over those that know it: the model of one cluster.
[[nodiscard]] Centroid mean_of(const VectorSet& vectors);

}  // namespace strata::patch
