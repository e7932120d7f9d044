// SPDX-License-Identifier: Apache-2.0
#include <numeric>
#include <string>

#include <gtest/gtest.h>

#include "core/patch/sequences.hpp"
#include "tools/laboratory/experiments/box_way.hpp"
#include "tools/laboratory/experiments/cluster_rows.hpp"

namespace strata::experiments {
namespace {

constexpr std::uint64_t kUnusedSeed = 102;  // no figure uses it

std::string drawn_scenario(const char* name) {
  return std::string(STRATA_SCENARIO_DIR) + "/" + name;
}

TEST(BoxWay, GoesThroughTheSubmapOnceAndKnowsItsStateThen) {
  const auto way = way_through_box(drawn_scenario("corridor_box.yaml"), kUnusedSeed, "patch");
  ASSERT_TRUE(way);
  const auto& rect = way->map.submaps[way->submap].rect;
  const auto away_m = [&](std::size_t i) {
    return patch::distance_m(way->points[i].truth.translation(), rect,
                             way->map.base.resolution_m());
  };
  ASSERT_GT(way->entered, 0U);
  ASSERT_LT(way->entered, way->left);
  ASSERT_LT(way->left + 1, way->points.size());
  EXPECT_GT(away_m(way->entered - 1), way->map.entry_margin_m);
  EXPECT_GT(away_m(way->left + 1), way->map.entry_margin_m);
  for (std::size_t i = way->entered; i <= way->left; ++i) {
    EXPECT_LE(away_m(i), way->map.entry_margin_m);
  }
  for (const WayPoint& point : way->points) {
    const double known = std::accumulate(point.probability.begin(), point.probability.end(), 0.0);
    EXPECT_LE(known, 1.0 + 1e-6) << "the rest is something else";
    EXPECT_GT(known, 0.9);
  }
  EXPECT_GT(way->probability(way->left), 0.9);
  EXPECT_LT(way->error_m(), 0.3);
  EXPECT_GT(way->error_m(), 0.0);
}

TEST(ClusterRows, EndWithFourClustersAsTheLearnerDoes) {
  const auto rows = cluster_rows(drawn_scenario("four_states.yaml"), kUnusedSeed);
  ASSERT_TRUE(rows);
  // Seventeen days, each there and back.
  EXPECT_EQ(rows->states.size(), 34U);
  EXPECT_EQ(rows->local_maps.size(), 34U);
  ASSERT_EQ(rows->rows.size(), 5U);
  for (std::size_t k = 0; k < 5; ++k) EXPECT_EQ(rows->rows[k].centroids.size(), k + 1);
  EXPECT_EQ(rows->best(), 3U);
  EXPECT_EQ(rows->submap.configurations.size(), 4U);
  EXPECT_EQ(rows->rightly_clustered(), 34U);
  EXPECT_TRUE(rows->splits_a_state());
  EXPECT_GT(rows->mean_membership(), 0.5);
  EXPECT_LT(rows->nearest_centres(4), rows->nearest_centres(3));
}

TEST(ClusterRows, CountWhatLiesInTheClusterOfAnotherState) {
  ClusterRows rows;
  rows.states = {0, 0, 0, 1, 1};
  rows.local_maps.dimension = 1;
  rows.local_maps.values.assign(5, 0.0F);
  rows.rows.resize(1);
  rows.rows[0].centroids = {{0.0}, {3.0}};
  rows.rows[0].memberships = {{0.9, 0.1}, {0.8, 0.2}, {0.3, 0.7}, {0.2, 0.8}, {0.1, 0.9}};
  rows.criterion = {1.0};
  EXPECT_EQ(rows.rightly_clustered(), 4U);
  EXPECT_NEAR(rows.mean_membership(), 0.82, 1e-12);
  EXPECT_EQ(rows.nearest_centres(0), 3.0);
  EXPECT_FALSE(rows.splits_a_state()) << "there is no row with one more";
  rows.rows.push_back(rows.rows[0]);
  rows.criterion.push_back(0.0);
  EXPECT_FALSE(rows.splits_a_state()) << "the newest cluster has maps of both states";
  rows.rows[1].memberships[2] = {0.9, 0.1};
  EXPECT_FALSE(rows.splits_a_state()) << "its state has no other cluster";
  rows.rows[1].memberships[3] = {0.9, 0.1};
  EXPECT_TRUE(rows.splits_a_state());
}

}  // namespace
}  // namespace strata::experiments
