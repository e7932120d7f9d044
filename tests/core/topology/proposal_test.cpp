// SPDX-License-Identifier: Apache-2.0
#include "core/topology/proposal.hpp"

#include <vector>

#include <gtest/gtest.h>

namespace strata::topology {
namespace {

TEST(TopologyFilter, MakesOneLandmarkOfTwoThatALaterLoopBringsTogether) {
  Hypothesis hypothesis;
  hypothesis.labels = {0, 1, 2, 0};
  hypothesis.poses = {{0, 0, 0}, {5, 0, 1}, {5.4, 0.3, 2}, {0, 0, 0}};
  const LocationPriorConfig config;
  EXPECT_EQ(mergers(hypothesis, config), (std::vector<Labels>{{0, 1, 1, 0}}));
  hypothesis.poses[2].x = 7.0;
  EXPECT_TRUE(mergers(hypothesis, config).empty());
}

TEST(TopologyFilter, MovesAVisitToTheLandmarkThatALaterLoopPutsItAt) {
  Hypothesis hypothesis;
  hypothesis.labels = {0, 1, 1, 0};
  hypothesis.poses = {{0, 0, 0}, {5, 0, 1}, {0.3, 0, 2}, {0.2, 0, 0}};
  const LocationPriorConfig config;
  EXPECT_EQ(moved_visits(hypothesis, config), (std::vector<Labels>{{0, 1, 0, 0}, {0, 1, 2, 0}}));
  hypothesis.poses[2] = {6.2, 0, 2};  // beyond its own landmark, and far from the other
  EXPECT_EQ(moved_visits(hypothesis, config), (std::vector<Labels>{{0, 1, 2, 0}}));
  hypothesis.poses[2].x = 5.8;
  EXPECT_TRUE(moved_visits(hypothesis, config).empty());
}

}  // namespace
}  // namespace strata::topology
