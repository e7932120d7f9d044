// SPDX-License-Identifier: Apache-2.0
#include "core/patch/fuzzy_kmeans.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace strata::patch {
namespace {

constexpr double kMinSquaredDistance = 1e-9;
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// mu_cj over the vectors that know entry j; the greatest move of a known entry.
double update_centroid(const VectorSet& vectors, const std::vector<double>& weights,
                       Centroid& centroid) {
  std::vector<double> sum(vectors.dimension, 0.0);
  std::vector<double> weight(vectors.dimension, 0.0);
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    const auto row = vectors.row(i);
    for (std::size_t j = 0; j < row.size(); ++j) {
      if (std::isnan(row[j])) continue;
      sum[j] += weights[i] * static_cast<double>(row[j]);
      weight[j] += weights[i];
    }
  }
  double moved = 0.0;
  for (std::size_t j = 0; j < centroid.size(); ++j) {
    const double next = weight[j] > 0.0 ? sum[j] / weight[j] : kUnknown;
    if (std::isnan(next) != std::isnan(centroid[j])) {
      moved = 1.0;
    } else if (!std::isnan(next)) {
      moved = std::max(moved, std::abs(next - centroid[j]));
    }
    centroid[j] = next;
  }
  return moved;
}

double objective(const VectorSet& vectors, const std::vector<Centroid>& centroids,
                 const std::vector<std::vector<double>>& memberships,
                 const FuzzyKMeansConfig& config) {
  double sum = 0.0;
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    for (std::size_t c = 0; c < centroids.size(); ++c) {
      sum += std::pow(memberships[i][c], config.fuzziness) *
             squared_distance(vectors.row(i), centroids[c], config.epsilon);
    }
  }
  return sum;
}

}  // namespace

double squared_distance(std::span<const float> a, std::span<const double> b, double epsilon) {
  double sum = 0.0;
  for (std::size_t j = 0; j < a.size(); ++j) {
    const bool a_known = !std::isnan(a[j]);
    const bool b_known = !std::isnan(b[j]);
    if (a_known && b_known) {
      const double difference = static_cast<double>(a[j]) - b[j];
      sum += difference * difference;
    } else if (a_known != b_known) {
      sum += epsilon;
    }
  }
  return sum;
}

std::vector<std::vector<double>> memberships_of(const VectorSet& vectors,
                                                const std::vector<Centroid>& centroids,
                                                const FuzzyKMeansConfig& config) {
  std::vector<std::vector<double>> result(vectors.size(), std::vector<double>(centroids.size()));
  const double exponent = -1.0 / (config.fuzziness - 1.0);
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    std::vector<double>& row = result[i];
    double greatest = -std::numeric_limits<double>::infinity();
    for (std::size_t c = 0; c < centroids.size(); ++c) {
      const double d2 = squared_distance(vectors.row(i), centroids[c], config.epsilon);
      row[c] = exponent * std::log(std::max(d2, kMinSquaredDistance));
      greatest = std::max(greatest, row[c]);
    }
    double sum = 0.0;
    for (double& u : row) sum += (u = std::exp(u - greatest));
    for (double& u : row) u /= sum;
  }
  return result;
}

Centroid mean_of(const VectorSet& vectors) {
  Centroid mean(vectors.dimension, kUnknown);
  update_centroid(vectors, std::vector<double>(vectors.size(), 1.0), mean);
  return mean;
}

FuzzyClusters fuzzy_kmeans(const VectorSet& vectors, std::vector<Centroid> centroids,
                           const FuzzyKMeansConfig& config) {
  FuzzyClusters result;
  result.centroids = std::move(centroids);
  std::vector<double> weights(vectors.size());
  for (int sweep = 0; sweep < config.max_sweeps && !result.converged; ++sweep) {
    result.memberships = memberships_of(vectors, result.centroids, config);
    double moved = 0.0;
    for (std::size_t c = 0; c < result.centroids.size(); ++c) {
      for (std::size_t i = 0; i < vectors.size(); ++i) {
        weights[i] = std::pow(result.memberships[i][c], config.fuzziness);
      }
      moved = std::max(moved, update_centroid(vectors, weights, result.centroids[c]));
    }
    result.objective.push_back(objective(vectors, result.centroids, result.memberships, config));
    result.converged = moved < config.tolerance;
  }
  result.memberships = memberships_of(vectors, result.centroids, config);
  return result;
}

}  // namespace strata::patch
