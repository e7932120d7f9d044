// SPDX-License-Identifier: Apache-2.0
#include "core/topology/partition.hpp"

#include <cmath>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/random/stream.hpp"
#include "core/topology/dirichlet_process.hpp"
#include "core/topology/location_prior.hpp"
#include "tests/core/topology/all_partitions.hpp"

namespace strata::topology {
namespace {

using testing::ElementsAre;

TEST(Partition, EnumerationVisitsEachOnceAndBellCountsThem) {
  for (const auto& [n, expected] : {std::pair{1U, 1U}, {3U, 5U}, {7U, 877U}, {9U, 21147U}}) {
    std::set<Labels> seen;
    for_each_partition(n, [&](const Labels& labels) {
      EXPECT_TRUE(is_canonical(labels));
      EXPECT_TRUE(seen.insert(labels).second);
    });
    EXPECT_EQ(seen.size(), expected);
    EXPECT_EQ(bell_number(n), expected);
  }
  EXPECT_EQ(bell_number(12), 4'213'597U);
  EXPECT_EQ(bell_number(20), 51'724'158'235'372U);
}

TEST(Partition, CanonicalLabelsForgetNames) {
  EXPECT_THAT(canonical({7, 3, 7, -1, 3}), ElementsAre(0, 1, 0, 2, 1));
  EXPECT_TRUE(is_canonical({0, 1, 0, 2, 1}));
  EXPECT_FALSE(is_canonical({0, 2}));
  EXPECT_FALSE(is_canonical({1}));
  EXPECT_FALSE(is_canonical({0, -1}));
  EXPECT_EQ(landmark_count({0, 1, 0, 2}), 3);
  EXPECT_THAT(first_visits({0, 1, 0, 2, 1}), ElementsAre(0U, 1U, 3U));
}

TEST(DirichletProcess, SumsToOneOverAllPartitions) {
  double total = 0.0;
  for_each_partition(
      8, [&](const Labels& labels) { total += std::exp(log_partition_prior(labels, 3.0)); });
  EXPECT_NEAR(total, 1.0, 1e-12);
}

TEST(DirichletProcess, GivesAPartitionTheSameProbabilityInAnyOrderOfVisits) {
  const Labels labels{0, 1, 0, 2, 1, 0};
  Labels backwards(labels.rbegin(), labels.rend());
  EXPECT_NEAR(log_partition_prior(labels, 0.7), log_partition_prior(canonical(backwards), 0.7),
              1e-12);
}

TEST(DirichletProcess, ExpectsAsManyLandmarksAsItsClosedFormSays) {
  for (const double c : {0.5, 3.0}) {
    double expected = 0.0;
    for_each_partition(8, [&](const Labels& labels) {
      expected += landmark_count(labels) * std::exp(log_partition_prior(labels, c));
    });
    EXPECT_NEAR(expected_landmarks(8, c), expected, 1e-10);
  }
  EXPECT_NEAR(expected_landmarks(12, 3.0), 5.25, 0.01);
  EXPECT_NEAR(expected_landmarks(20, 3.0), 6.6, 0.05);
}

// The printed denominator n + c would make this sum to (n - 1 + c) / (n + c).
TEST(DirichletProcess, NextLabelSumsToOneUnlikeAsPrinted) {
  const std::vector<double> prior = label_prior({0, 1, 0}, 3.0);
  EXPECT_THAT(prior, ElementsAre(testing::DoubleEq(2.0 / 6.0), testing::DoubleEq(1.0 / 6.0),
                                 testing::DoubleEq(3.0 / 6.0)));
}

TEST(LocationPrior, JoinsZeroSmoothlyAndItsDerivativesAreItsSlopes) {
  const LocationPriorConfig config;
  EXPECT_DOUBLE_EQ(penalty_at(0.0, config).value, 15.0);
  EXPECT_DOUBLE_EQ(penalty_at(10.0, config).value, 0.0);
  EXPECT_NEAR(penalty_at(10.0 - 1e-6, config).slope, 0.0, 1e-5);
  for (const double d : {0.3, 2.0, 5.0, 9.5}) {
    const double h = 1e-5;
    const Penalty below = penalty_at(d - h, config);
    const Penalty above = penalty_at(d + h, config);
    EXPECT_NEAR(penalty_at(d, config).slope, (above.value - below.value) / (2.0 * h), 1e-7);
    EXPECT_NEAR(penalty_at(d, config).curve, (above.slope - below.slope) / (2.0 * h), 1e-7);
  }
}

}  // namespace
}  // namespace strata::topology
