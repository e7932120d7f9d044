// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "core/random/stream.hpp"
#include "memory/decoding/decode.hpp"
#include "memory/decoding/graph.hpp"

namespace strata::memory {
namespace {

constexpr float kUnseenBin = std::numeric_limits<float>::quiet_NaN();

double p(const NodeLevel& level, std::size_t row, std::size_t i, std::size_t j,
         DecodingConfig config = scene_decoding()) {
  return std::exp(-build_graph(level, config).edges_from(row, i)[j]);
}

/// Scene A (1 m) six times and scene B (3 m) fourteen times, where each bin knows it.
NodeLevel two_scenes(const VirtualScan& a, const VirtualScan& b) {
  NodeLevel level({static_cast<int>(a.size()), 40, 4.0}, 20, false);
  RandomStream random(1, StreamId::kTest);
  for (int i = 0; i < 6; ++i) level.insert(a, random);
  for (int i = 0; i < 14; ++i) level.insert(b, random);
  return level;
}

TEST(SceneGraph, ChargesStepsWithinASceneForTheirShareOfSamplesOnly) {
  const NodeLevel level = two_scenes({1.05F, 1.05F, kUnseenBin}, {3.05F, 3.05F, kUnseenBin});
  EXPECT_NEAR(p(level, 0, 0, 0), std::pow(0.3, 0.1), 1e-12);
  EXPECT_NEAR(p(level, 0, 1, 1), std::pow(0.7, 0.1), 1e-12);
  DecodingConfig no_evidence = scene_decoding();
  no_evidence.evidence = 0.0;
  EXPECT_NEAR(p(level, 0, 0, 0, no_evidence), 1.0, 1e-12);
}

TEST(SceneGraph, ChargesAContradictionByHowOftenItCouldHaveBeenSeen) {
  const NodeLevel level = two_scenes({1.05F, 1.05F, kUnseenBin}, {3.05F, 3.05F, kUnseenBin});
  // A goes on in A six times, and B comes from B fourteen times: the latter is the stronger.
  EXPECT_NEAR(p(level, 0, 0, 1), 0.1 / 14.1 * std::pow(0.7, 0.1), 1e-12);
  EXPECT_NEAR(p(level, 0, 1, 0), 0.1 / 14.1 * std::pow(0.3, 0.1), 1e-12);
}

TEST(SceneGraph, CountsTheRangeBinBesideByHalfAndAsAConditionByAFifth) {
  // In bin 0 the scenes lie side by side, in range bins 10 and 11.
  const NodeLevel level = two_scenes({1.05F, 1.05F, kUnseenBin}, {1.15F, 3.05F, kUnseenBin});
  const double share = 0.3 + 0.5 * 0.7;
  EXPECT_NEAR(p(level, 2, 0, 0), std::pow(share, 0.1), 1e-12);
  // From 10 on to B's 30: 14 pairs a fifth each, beside 6 that lead to A's 10.
  const double follows = (0.2 * 14.0 / 0.7 + 0.1) / (6.0 + 0.2 * 14.0 + 0.1);
  const double precedes = (0.5 * 14.0 / share + 0.1) / (14.0 + 0.1);
  ASSERT_LT(follows, precedes);
  EXPECT_NEAR(p(level, 0, 0, 1), follows * std::pow(0.7, 0.1), 1e-12);
}

TEST(SceneGraph, HasAWildcardThatIsEnteredWhereASceneIsNotSeenOn) {
  // B is not seen in bin 1, A is.
  const NodeLevel level = two_scenes({1.05F, 1.05F, 1.05F}, {3.05F, kUnseenBin, 3.05F});
  const LayeredGraph graph = build_graph(level, scene_decoding());
  ASSERT_EQ(graph.states(0).size(), 3U);
  EXPECT_EQ(graph.states(0)[2], LayeredGraph::kWildcard);
  const double unseen = std::pow(0.85, 0.1);
  EXPECT_NEAR(p(level, 0, 1, 1), unseen / (1.0 + 9.0 * std::exp(-14.0)), 1e-12);
  EXPECT_NEAR(p(level, 1, 1, 1), std::pow(0.7, 0.1) / (1.0 + 9.0 * std::exp(-14.0)), 1e-12);
  // A is: whoever leaves it contradicts six pairs.
  EXPECT_NEAR(p(level, 0, 0, 1), unseen * 0.1 / 6.1 / (1.0 + 9.0 * std::exp(-6.0)), 1e-12);
}

TEST(SceneGraph, ChargesAWildcardByHowManySurfacesItsSamplesShow) {
  // Two surfaces in bin 0; one, askew, in bin 1.
  const NodeLevel level = two_scenes({1.05F, 1.05F, kUnseenBin}, {3.05F, 1.15F, kUnseenBin});
  const double two_alike = 0.3 * 0.3 + 0.7 * 0.7;
  EXPECT_NEAR(p(level, 2, 0, 2), two_alike * std::pow(0.85 * 0.7, 0.1), 1e-12);
  EXPECT_NEAR(p(level, 0, 2, 2), std::pow(0.85 * (0.7 + 0.5 * 0.3), 0.1), 1e-12);
}

// Otherwise a path that is unknown everywhere would be the cheapest.
TEST(SceneGraph, PrefersAStateToTheWildcardWhereOneSurfaceScatters) {
  NodeLevel level({3, 40, 4.0}, 20, false);
  RandomStream random(1, StreamId::kTest);
  for (int i = 0; i < 21; ++i) {
    level.insert(VirtualScan(3, 1.05F + 0.1F * static_cast<float>(i % 3)), random);
  }
  const LayeredGraph graph = build_graph(level, scene_decoding());
  const ClosedPath path = search_layered(graph);
  for (std::size_t row = 0; row < 3; ++row) {
    EXPECT_NE(graph.states(row)[path.states[row]], LayeredGraph::kWildcard);
  }
}

TEST(SceneGraph, KeepsItsBestPathThroughAnAngleBinThatOnlyAnotherSceneShows) {
  const NodeLevel level =
      two_scenes({1.05F, 1.05F, 1.05F, 1.05F, 1.05F}, {3.05F, 3.05F, kUnseenBin, 3.05F, 3.05F});
  const DecodedScan scan = decode(level, scene_decoding());
  EXPECT_EQ(scan.range_m, (std::vector<float>{3.05F, 3.05F, 1.05F, 3.05F, 3.05F}));
  EXPECT_FALSE(scan.inconsistent);
}

/// Scenes that look alike in the bins 0 to 3 and part from 4 on; of bin 4 the pairs that lead to A
/// happen to be more, in all other bins B is.
NodeLevel parted_by_chance() {
  NodeLevel level({12, 40, 4.0}, 20, false);
  RandomStream random(1, StreamId::kTest);
  VirtualScan a(12, 2.05F);
  VirtualScan b(12, 2.05F);
  std::fill(a.begin() + 4, a.end(), 1.05F);
  std::fill(b.begin() + 4, b.end(), 3.05F);
  VirtualScan b_beyond = b;
  b_beyond[3] = kUnseenBin;
  for (int i = 0; i < 5; ++i) level.insert(a, random);
  for (int i = 0; i < 3; ++i) level.insert(b, random);
  for (int i = 0; i < 12; ++i) level.insert(b_beyond, random);
  return level;
}

TEST(SceneGraph, LetsAllBinsVoteWhereTheExactProductAsksOnePair) {
  EXPECT_EQ(decode(parted_by_chance(), exact_decoding()).range_m[8], 1.05F);
  EXPECT_EQ(decode(parted_by_chance(), scene_decoding()).range_m[8], 3.05F);
}

/// By trying all of them; kNoEdge for none.
double least_cost_of_all(const LayeredGraph& graph) {
  double least = kNoEdge;
  std::vector<std::size_t> path(graph.rows(), 0);
  for (std::size_t row = 0; row < graph.rows();) {
    double cost = 0.0;
    for (std::size_t a = 0; a < graph.rows(); ++a) {
      cost += graph.edges_from(a, path[a])[path[graph.next(a)]];
    }
    least = std::min(least, cost);
    for (row = 0; row < path.size() && ++path[row] == graph.states(row).size(); ++row) {
      path[row] = 0;
    }
  }
  return least;
}

void expect_cheapest_paths(const DecodingConfig& config) {
  RandomStream random(4, StreamId::kTest);
  for (int trial = 0; trial < 40; ++trial) {
    NodeLevel level({5, 6, 3.0}, 6, false);
    VirtualScan scan(5);
    for (int t = 0; t < 8; ++t) {
      for (float& range : scan) {
        range = random.bernoulli(0.2) ? kUnseenBin : static_cast<float>(random.uniform(0.0, 3.4));
      }
      level.insert(scan, random);
    }
    const LayeredGraph graph = build_graph(level, config);
    const double least = least_cost_of_all(graph);
    for (const ClosedPath& path : {search_layered(graph), search_dijkstra(graph)}) {
      ASSERT_EQ(path.found, least < kNoEdge) << trial;
      if (path.found) {
        EXPECT_NEAR(path.cost, least, 1e-12 * std::max(1.0, least)) << trial;
      }
    }
  }
}

TEST(SceneGraph, GivesTheCheapestOfAllClosedPathsByBothSearches) {
  expect_cheapest_paths(scene_decoding());
}

TEST(SceneGraph, HasCheapestPathsAtTheEndsOfItsSettingsToo) {
  DecodingConfig config = scene_decoding();
  config.smoothing = 0.0;
  expect_cheapest_paths(config);
  config.evidence = 0.0;
  expect_cheapest_paths(config);
  config.cost = PathCost::kReciprocal;
  expect_cheapest_paths(config);
  config = scene_decoding();
  config.evidence = 1.0;
  expect_cheapest_paths(config);
}

}  // namespace
}  // namespace strata::memory
