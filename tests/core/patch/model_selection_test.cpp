// SPDX-License-Identifier: Apache-2.0
#include "core/patch/model_selection.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "core/random/stream.hpp"

namespace strata::patch {
namespace {

/// n vectors that repeat `states` random 0/1 maps in turn, each cell with noise, some unknown.
VectorSet noisy_states(std::size_t n, std::size_t states, std::size_t dimension, double noise,
                       double unknown, RandomStream& random) {
  std::vector<std::vector<float>> truth(states, std::vector<float>(dimension));
  for (auto& state : truth) {
    for (float& cell : state) cell = random.bernoulli(0.5) ? 1.0F : 0.0F;
  }
  VectorSet vectors{dimension, {}};
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < dimension; ++j) {
      const double value = static_cast<double>(truth[i % states][j]) + random.normal(0.0, noise);
      vectors.values.push_back(random.bernoulli(unknown)
                                   ? std::nanf("")
                                   : static_cast<float>(std::clamp(value, 0.0, 1.0)));
    }
  }
  return vectors;
}

TEST(ModelSelection, LikelihoodOfOneClusterIsTheProductOfNormals) {
  const VectorSet vectors{2, {0.1F, 0.4F}};
  FuzzyClusters model;
  model.centroids = {{0.3, 0.4}};
  model.memberships = {{1.0}};
  const double peak = -std::log(0.2 * std::sqrt(2.0 * std::numbers::pi));
  EXPECT_NEAR(log_likelihoods(vectors, model, 0.2)[0], 2.0 * peak - 0.5, 1e-6);
}

TEST(ModelSelection, UnknownCellsAreMarginalized) {
  VectorSet vectors{2, {0.3F, std::nanf("")}};
  FuzzyClusters model;
  model.centroids = {{0.3, 0.9}};
  model.memberships = {{1.0}};
  EXPECT_NEAR(log_likelihoods(vectors, model, 0.2)[0],
              -std::log(0.2 * std::sqrt(2.0 * std::numbers::pi)), 1e-6);
}

// Defect 2: what |theta| of the criterion counts. Cells: D for each cluster, by the vectors that it
// is estimated from, and k - 1 shares; the paper's wording: k.
TEST(ModelSelection, ThetaCountsCellsOrClusters) {
  RandomStream random(1, StreamId::kTest);
  const VectorSet vectors = noisy_states(9, 3, 10, 0.1, 0.0, random);
  const FuzzyClusters model = fuzzy_kmeans(vectors, {Centroid(10, 0.2), Centroid(10, 0.8)}, {});
  ModelSelectionConfig cells;
  ModelSelectionConfig clusters;
  clusters.theta_mode = ThetaMode::kClusters;
  double share = 0.0;
  for (const auto& row : model.memberships) share += row[0] / 9.0;
  EXPECT_NEAR(
      bayesian_information(vectors, model, clusters) - bayesian_information(vectors, model, cells),
      0.5 * (10.0 * (std::log1p(9.0 * share) + std::log1p(9.0 * (1.0 - share))) +
             (1.0 - 2.0) * std::log(9.0)),
      1e-9);
}

// Defect 2, the consequence: one noisy state is split when only clusters are counted.
TEST(ModelSelection, CountingOnlyClustersSplitsOneNoisyState) {
  RandomStream random(2, StreamId::kTest);
  VectorSet vectors = noisy_states(17, 1, 40, 0.0, 0.0, random);
  // Errors of pose flip a few cells.
  for (float& value : vectors.values) {
    if (random.bernoulli(0.05)) value = 1.0F - value;
  }
  ModelSelectionConfig config;
  EXPECT_EQ(select_clusters(vectors, config).k(), 1U);
  config.theta_mode = ThetaMode::kClusters;
  EXPECT_GT(select_clusters(vectors, config).k(), 1U);
}

TEST(ModelSelection, FindsFourStatesInSeventeenMaps) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    RandomStream random(seed, StreamId::kTest);
    const VectorSet vectors = noisy_states(17, 4, 40, 0.15, 0.0, random);
    std::vector<std::size_t> tried;
    const Clustering result = select_clusters(
        vectors, {}, [&](const FuzzyClusters& model) { tried.push_back(model.centroids.size()); });
    ASSERT_EQ(result.k(), 4U) << "seed " << seed;
    EXPECT_EQ(tried, (std::vector<std::size_t>{1, 2, 3, 4, 5})) << "seed " << seed;
    // Same state, same cluster; other state, other cluster.
    for (std::size_t i = 0; i < vectors.size(); ++i) {
      for (std::size_t c = 0; c < 4; ++c) {
        const double here = result.clusters.memberships[i][c];
        EXPECT_NEAR(here, result.clusters.memberships[i % 4][c], 0.1) << "seed " << seed;
      }
    }
    // The criterion fell when the fifth cluster came, and that ended the search.
    ASSERT_EQ(result.criterion.size(), 5U);
    EXPECT_LT(result.criterion[4], result.criterion[3]);
  }
}

TEST(ModelSelection, FindsFourStatesWithAThirdOfTheCellsUnknown) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    RandomStream random(seed, StreamId::kTest);
    const VectorSet vectors = noisy_states(17, 4, 60, 0.1, 0.33, random);
    EXPECT_EQ(select_clusters(vectors, {}).k(), 4U) << "seed " << seed;
  }
}

TEST(ModelSelection, OneStateStaysOneConfiguration) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    RandomStream random(seed, StreamId::kTest);
    const std::size_t n = 1 + random.below(40);
    EXPECT_EQ(select_clusters(noisy_states(n, 1, 30, 0.15, 0.1, random), {}).k(), 1U)
        << "seed " << seed;
  }
}

TEST(ModelSelection, TwoVisitsInTwoStatesAreTwoConfigurations) {
  VectorSet vectors{12, std::vector<float>(12, 0.0F)};
  vectors.values.resize(24, 1.0F);
  EXPECT_EQ(select_clusters(vectors, {}).k(), 2U);
}

TEST(ModelSelection, TooFewContradictoryCellsStayOneConfiguration) {
  const VectorSet vectors{3, {0, 0, 0, 1, 1, 1, 0, 0, 0, 1, 1, 1}};
  EXPECT_EQ(select_clusters(vectors, {}).k(), 1U);
}

// A vector that knows little has a density of few factors; that must not make it a seed.
TEST(ModelSelection, AVectorThatKnowsLittleIsNotASeed) {
  VectorSet vectors{20, {}};
  for (int i = 0; i < 6; ++i)
    vectors.values.resize(vectors.values.size() + 20, i % 2 ? 1.0F : 0.0F);
  vectors.values.push_back(1.0F);
  vectors.values.resize(vectors.values.size() + 19, std::nanf(""));
  const Clustering result = select_clusters(vectors, {});
  ASSERT_EQ(result.k(), 2U);
  const auto& u = result.clusters.memberships;
  EXPECT_GT(u[0][0] > 0.5 ? u[1][1] : u[1][0], 0.99);
  EXPECT_GT(u[6][0] > 0.5 ? u[1][0] : u[1][1], 0.99);
}

}  // namespace
}  // namespace strata::patch
