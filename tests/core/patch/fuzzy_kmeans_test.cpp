// SPDX-License-Identifier: Apache-2.0
#include "core/patch/fuzzy_kmeans.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "core/random/stream.hpp"

namespace strata::patch {
namespace {

constexpr float kXi = std::numeric_limits<float>::quiet_NaN();
constexpr double kXiCentroid = std::numeric_limits<double>::quiet_NaN();

VectorSet vectors_of(std::size_t dimension, std::vector<float> values) {
  return {dimension, std::move(values)};
}

TEST(PatchDistance, SumsSquaresOverKnownEpsilonOverHalfKnownNothingOverUnknown) {
  const std::vector<float> a{1.0F, 0.25F, kXi, kXi, 0.5F};
  const Centroid b{0.0, 0.75, 0.4, kXiCentroid, kXiCentroid};
  EXPECT_DOUBLE_EQ(squared_distance(a, b, 1e-3), 1.0 + 0.25 + 1e-3 + 0.0 + 1e-3);
}

// Defect 1 of the papers: with the printed signed difference these two maps have distance 0.
TEST(PatchDistance, IsPositiveForABoxThatMovedFromOneCellToAnother) {
  const std::vector<float> here{1.0F, 0.0F};
  const Centroid there{0.0, 1.0};
  EXPECT_DOUBLE_EQ(squared_distance(here, there, 1e-3), 2.0);
}

TEST(FuzzyKMeans, MembershipsFollowTheInverseDistanceLaw) {
  // Distances 1 and 2 (squared 1 and 4); b = 2: u ~ d^-2 = 1 : 1/4.
  const VectorSet one = vectors_of(1, {0.0F});
  FuzzyKMeansConfig config;
  config.fuzziness = 2.0;
  const auto u = memberships_of(one, {{1.0}, {2.0}}, config);
  EXPECT_NEAR(u[0][0], 0.8, 1e-12);
  EXPECT_NEAR(u[0][1], 0.2, 1e-12);
  // b = 1.5: u ~ d^-4 = 1 : 1/16.
  config.fuzziness = 1.5;
  EXPECT_NEAR(memberships_of(one, {{1.0}, {2.0}}, config)[0][0], 16.0 / 17.0, 1e-12);
}

TEST(FuzzyKMeans, OneClusterIsTheMeanOverTheVectorsThatKnowTheCell) {
  const VectorSet vectors = vectors_of(3, {0.0F, 1.0F, kXi, 0.5F, kXi, kXi});
  const FuzzyClusters result = fuzzy_kmeans(vectors, {mean_of(vectors)}, {});
  EXPECT_TRUE(result.converged);
  EXPECT_DOUBLE_EQ(result.centroids[0][0], 0.25);
  EXPECT_DOUBLE_EQ(result.centroids[0][1], 1.0);
  EXPECT_TRUE(std::isnan(result.centroids[0][2]));
  EXPECT_DOUBLE_EQ(result.memberships[1][0], 1.0);
}

TEST(FuzzyKMeans, TwoPointsTwoCentresSplitExactly) {
  const VectorSet vectors = vectors_of(2, {0.0F, 0.0F, 1.0F, 1.0F});
  const FuzzyClusters result = fuzzy_kmeans(vectors, {{0.1, 0.1}, {0.8, 0.9}}, {});
  EXPECT_TRUE(result.converged);
  EXPECT_NEAR(result.centroids[0][0], 0.0, 1e-3);
  EXPECT_NEAR(result.centroids[1][1], 1.0, 1e-3);
  EXPECT_GT(result.memberships[0][0], 0.999);
  EXPECT_GT(result.memberships[1][1], 0.999);
}

TEST(FuzzyKMeans, ObjectiveNeverRisesAndMembershipsSumToOne) {
  for (std::uint32_t seed = 0; seed < 50; ++seed) {
    RandomStream random(seed, StreamId::kTest);
    const std::size_t dimension = 1 + random.below(12);
    const std::size_t count = 2 + random.below(20);
    VectorSet vectors{dimension, {}};
    for (std::size_t i = 0; i < count * dimension; ++i) {
      vectors.values.push_back(random.bernoulli(0.2) ? kXi : static_cast<float>(random.uniform()));
    }
    std::vector<Centroid> centroids(1 + random.below(4), mean_of(vectors));
    for (Centroid& centroid : centroids) {
      for (double& x : centroid) x += random.uniform(-0.2, 0.2);
    }
    FuzzyKMeansConfig config;
    config.fuzziness = random.uniform(1.2, 2.5);
    const FuzzyClusters result = fuzzy_kmeans(vectors, centroids, config);
    for (std::size_t s = 1; s < result.objective.size(); ++s) {
      EXPECT_LE(result.objective[s], result.objective[s - 1] + 1e-9) << "seed " << seed;
    }
    for (const auto& row : result.memberships) {
      double sum = 0.0;
      for (const double u : row) sum += u;
      EXPECT_NEAR(sum, 1.0, 1e-12) << "seed " << seed;
    }
  }
}

// Maps that agree where both are known must share a cluster however little they overlap.
TEST(FuzzyKMeans, UnknownHalvesDoNotMakeAVectorAnOutlier) {
  VectorSet vectors{8, {}};
  const std::vector<float> open(8, 0.0F);
  const std::vector<float> closed(8, 1.0F);
  for (int i = 0; i < 3; ++i) {
    vectors.values.insert(vectors.values.end(), open.begin(), open.end());
    vectors.values.insert(vectors.values.end(), closed.begin(), closed.end());
  }
  std::vector<float> partial(8, kXi);
  partial[0] = 1.0F;
  vectors.values.insert(vectors.values.end(), partial.begin(), partial.end());
  const FuzzyClusters result = fuzzy_kmeans(vectors, {Centroid(8, 0.1), Centroid(8, 0.9)}, {});
  EXPECT_GT(result.memberships.back()[1], 0.99);
}

}  // namespace
}  // namespace strata::patch
