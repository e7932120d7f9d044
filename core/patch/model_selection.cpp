// SPDX-License-Identifier: Apache-2.0
#include "core/patch/model_selection.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/log_sum.hpp"

namespace strata::patch {
namespace {

/// ln sum_c pi_c exp(-misfit_ic) per vector, and how many entries each vector shares with the
/// centres: the density without and with its normalizer.
struct Fit {
  double log_kernel = 0.0;
  double log_density = 0.0;
};

std::vector<double> mixture_weights(const FuzzyClusters& clusters) {
  std::vector<double> weights(clusters.centroids.size(), 0.0);
  for (const auto& row : clusters.memberships) {
    for (std::size_t c = 0; c < weights.size(); ++c) weights[c] += row[c];
  }
  for (double& w : weights) w /= static_cast<double>(clusters.memberships.size());
  return weights;
}

/// sum_j (a_j - mu_j)^2 over the entries known in both, and their number.
double squared_misfit(std::span<const float> vector, const Centroid& centroid, int& known) {
  double squared = 0.0;
  known = 0;
  for (std::size_t j = 0; j < vector.size(); ++j) {
    const double difference = static_cast<double>(vector[j]) - centroid[j];
    if (std::isnan(difference)) continue;
    squared += difference * difference;
    ++known;
  }
  return squared;
}

std::vector<Fit> fit(const VectorSet& vectors, const FuzzyClusters& clusters, double cell_stddev) {
  const std::vector<double> weights = mixture_weights(clusters);
  const double log_peak = -std::log(cell_stddev * std::sqrt(2.0 * std::numbers::pi));
  std::vector<Fit> result(vectors.size());
  std::vector<double> kernel(weights.size());
  std::vector<double> density(weights.size());
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    const auto row = vectors.row(i);
    for (std::size_t c = 0; c < weights.size(); ++c) {
      int known = 0;
      const double squared = squared_misfit(row, clusters.centroids[c], known);
      kernel[c] = std::log(weights[c]) - 0.5 * squared / (cell_stddev * cell_stddev);
      density[c] = kernel[c] + known * log_peak;
    }
    result[i] = {log_sum_exp(kernel), log_sum_exp(density)};
  }
  return result;
}

/// A new centre at the vector that fits worst.
Centroid seed_from_worst(const VectorSet& vectors, const FuzzyClusters& clusters,
                         double cell_stddev) {
  const std::vector<Fit> fits = fit(vectors, clusters, cell_stddev);
  std::size_t worst = 0;
  for (std::size_t i = 1; i < fits.size(); ++i) {
    if (fits[i].log_kernel < fits[worst].log_kernel) worst = i;
  }
  const auto& u = clusters.memberships[worst];
  const auto nearest = static_cast<std::size_t>(std::max_element(u.begin(), u.end()) - u.begin());
  Centroid seed = clusters.centroids[nearest];
  const auto row = vectors.row(worst);
  for (std::size_t j = 0; j < row.size(); ++j) {
    if (!std::isnan(row[j])) seed[j] = static_cast<double>(row[j]);
  }
  return seed;
}

}  // namespace

std::vector<double> log_likelihoods(const VectorSet& vectors, const FuzzyClusters& clusters,
                                    double cell_stddev) {
  std::vector<double> result;
  for (const Fit& one : fit(vectors, clusters, cell_stddev)) result.push_back(one.log_density);
  return result;
}

std::vector<std::vector<double>> likelihood_shares(const VectorSet& vectors,
                                                   const std::vector<Centroid>& centroids,
                                                   double cell_stddev) {
  std::vector<std::vector<double>> result(vectors.size(), std::vector<double>(centroids.size()));
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    std::vector<double>& row = result[i];
    int known = 0;
    for (std::size_t c = 0; c < centroids.size(); ++c) {
      const double squared = squared_misfit(vectors.row(i), centroids[c], known);
      row[c] = -0.5 * squared / (cell_stddev * cell_stddev);
    }
    const double all = log_sum_exp(row);
    for (double& share : row) share = std::exp(share - all);
  }
  return result;
}

double bayesian_information(const VectorSet& vectors, const FuzzyClusters& clusters,
                            const ModelSelectionConfig& config) {
  double sum = 0.0;
  for (const double l : log_likelihoods(vectors, clusters, config.cell_stddev)) sum += l;
  const auto k = static_cast<double>(clusters.centroids.size());
  const auto n = static_cast<double>(vectors.size());
  if (config.theta_mode == ThetaMode::kClusters) return sum - 0.5 * k * std::log(n);
  double penalty = (k - 1.0) * std::log(n);
  for (const double weight : mixture_weights(clusters)) {
    penalty += static_cast<double>(vectors.dimension) * std::log(1.0 + weight * n);
  }
  return sum - 0.5 * penalty;
}

Clustering select_clusters(const VectorSet& vectors, const ModelSelectionConfig& config,
                           const std::function<void(const FuzzyClusters&)>& each) {
  Clustering result;
  FuzzyClusters model = fuzzy_kmeans(vectors, {mean_of(vectors)}, config.fuzzy);
  double best = bayesian_information(vectors, model, config);
  result.criterion.push_back(best);
  if (each) each(model);
  result.clusters = model;
  if (vectors.dimension < static_cast<std::size_t>(config.min_features)) return result;
  int decreases = 0;
  while (model.centroids.size() < vectors.size() && decreases < config.patience) {
    std::vector<Centroid> centroids = model.centroids;
    centroids.push_back(seed_from_worst(vectors, model, config.cell_stddev));
    model = fuzzy_kmeans(vectors, std::move(centroids), config.fuzzy);
    const double criterion = bayesian_information(vectors, model, config);
    decreases = criterion < result.criterion.back() ? decreases + 1 : 0;
    result.criterion.push_back(criterion);
    if (each) each(model);
    if (criterion <= best) continue;
    best = criterion;
    result.clusters = model;
  }
  return result;
}

}  // namespace strata::patch
