// SPDX-License-Identifier: Apache-2.0
#include "memory/decoding/graph.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/random/stream.hpp"
#include "tests/memory/decoding/textbook_dijkstra.hpp"

namespace strata::memory {
namespace {

/// Tries every closed path.
ClosedPath search_brute_force(const LayeredGraph& graph) {
  ClosedPath best;
  std::vector<std::uint8_t> path(graph.rows(), 0);
  while (true) {
    double cost = graph.start_cost()[path[0]];
    for (std::size_t row = 0; row < graph.rows(); ++row) {
      cost += graph.edges_from(row, path[row])[path[graph.next(row)]];
    }
    if (cost < best.cost) best = {true, cost, path};
    std::size_t row = 0;
    while (row < graph.rows() && ++path[row] == graph.states(row).size()) path[row++] = 0;
    if (row == graph.rows()) return best;
  }
}

LayeredGraph random_graph(RandomStream& random, int max_rows, std::uint32_t max_states,
                          double missing) {
  LayeredGraph graph;
  const int rows = 1 + static_cast<int>(random.below(static_cast<std::uint32_t>(max_rows)));
  for (int row = 0; row < rows; ++row) {
    std::vector<std::uint8_t> states;
    const std::uint32_t width = 1 + random.below(max_states);
    for (std::uint32_t i = 0; i < width; ++i) states.push_back(static_cast<std::uint8_t>(i));
    graph.add_row(states);
  }
  graph.finish_rows();
  for (double& cost : graph.start_cost()) cost = random.uniform(0.0, 3.0);
  for (std::size_t row = 0; row < graph.rows(); ++row) {
    for (std::size_t i = 0; i < graph.states(row).size(); ++i) {
      for (std::size_t j = 0; j < graph.states(graph.next(row)).size(); ++j) {
        if (!random.bernoulli(missing)) graph.edge(row, i, j) = random.uniform(0.0, 3.0);
      }
    }
  }
  return graph;
}

double cost_of(const LayeredGraph& graph, const ClosedPath& path) {
  double cost = graph.start_cost()[path.states[0]];
  for (std::size_t row = 0; row < graph.rows(); ++row) {
    cost += graph.edges_from(row, path.states[row])[path.states[graph.next(row)]];
  }
  return cost;
}

TEST(ClosedPath, IsTheSameByLayersByDijkstraAndByBruteForce) {
  RandomStream random(20, StreamId::kTest);
  int found = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const LayeredGraph graph = random_graph(random, 5, 3, trial % 3 == 0 ? 0.5 : 0.1);
    const ClosedPath truth = search_brute_force(graph);
    const ClosedPath layered = search_layered(graph);
    const ClosedPath dijkstra = search_dijkstra(graph);
    ASSERT_EQ(layered.found, truth.found) << trial;
    ASSERT_EQ(dijkstra.found, truth.found) << trial;
    if (!truth.found) continue;
    ++found;
    EXPECT_NEAR(layered.cost, truth.cost, 1e-12);
    EXPECT_NEAR(dijkstra.cost, truth.cost, 1e-12);
    EXPECT_NEAR(cost_of(graph, layered), truth.cost, 1e-12);
    EXPECT_NEAR(cost_of(graph, dijkstra), truth.cost, 1e-12);
  }
  EXPECT_GT(found, 200);
  EXPECT_LT(found, 300);
}

TEST(ClosedPath, CostsTheSameByLayersAndByDijkstraOnLargeGraphs) {
  RandomStream random(21, StreamId::kTest);
  for (int trial = 0; trial < 20; ++trial) {
    const LayeredGraph graph = random_graph(random, 200, 20, 0.6);
    const ClosedPath layered = search_layered(graph);
    const ClosedPath dijkstra = search_dijkstra(graph);
    ASSERT_EQ(layered.found, dijkstra.found);
    if (!layered.found) continue;
    EXPECT_NEAR(layered.cost, dijkstra.cost, 1e-9 * dijkstra.cost);
    EXPECT_NEAR(cost_of(graph, layered), layered.cost, 1e-9 * layered.cost);
  }
}

/// As random_graph, 20 states in each row, with two halves that are never left but for a price: the
/// cheapest way out of a start leads to the other half, where its path may not end.
LayeredGraph graph_of_two_worlds(RandomStream& random, double price) {
  LayeredGraph graph;
  std::vector<std::uint8_t> states(20);
  for (std::size_t i = 0; i < states.size(); ++i) states[i] = static_cast<std::uint8_t>(i);
  for (int row = 0; row < 60; ++row) graph.add_row(states);
  graph.finish_rows();
  for (double& cost : graph.start_cost()) cost = random.uniform(0.0, 3.0);
  for (std::size_t row = 0; row < graph.rows(); ++row) {
    for (std::size_t i = 0; i < 20; ++i) {
      for (std::size_t j = 0; j < 20; ++j) {
        const bool crosses = (i < 10) != (j < 10);
        graph.edge(row, i, j) = random.uniform(i < 10 ? 2.0 : 0.0, 3.0) + (crosses ? price : 0.0);
      }
    }
  }
  return graph;
}

TEST(ClosedPath, IsThatOfTheTextbooksDijkstra) {
  RandomStream random(22, StreamId::kTest);
  int found = 0;
  for (int trial = 0; trial < 120; ++trial) {
    const double kind = random.uniform();
    const LayeredGraph graph = kind < 0.5   ? random_graph(random, 80, 12, 0.5 * kind)
                               : kind < 0.7 ? random_graph(random, 80, 12, 0.85)
                                            : graph_of_two_worlds(random, random.uniform(0.0, 60));
    const ClosedPath truth = textbook::search_dijkstra(graph);
    const ClosedPath path = search_dijkstra(graph);
    ASSERT_EQ(path.found, truth.found) << trial;
    found += truth.found ? 1 : 0;
    // Costs are drawn from a continuum: the best path is the only one of its cost.
    EXPECT_EQ(path.states, truth.states) << trial;
    EXPECT_EQ(path.cost, truth.cost) << trial;
  }
  EXPECT_GT(found, 80);
  EXPECT_LT(found, 120);
}

TEST(ClosedPath, WithEqualCostsEverywhereCostsWhatTheTextbookSays) {
  RandomStream random(23, StreamId::kTest);
  for (int trial = 0; trial < 50; ++trial) {
    LayeredGraph graph = random_graph(random, 40, 6, 0.4);
    for (double& cost : graph.start_cost()) cost = std::floor(cost);
    for (std::size_t row = 0; row < graph.rows(); ++row) {
      for (std::size_t i = 0; i < graph.states(row).size(); ++i) {
        for (std::size_t j = 0; j < graph.states(graph.next(row)).size(); ++j) {
          graph.edge(row, i, j) = std::floor(graph.edge(row, i, j));
        }
      }
    }
    const ClosedPath truth = textbook::search_dijkstra(graph);
    const ClosedPath path = search_dijkstra(graph);
    ASSERT_EQ(path.found, truth.found) << trial;
    EXPECT_EQ(path.cost, truth.cost) << trial;
    if (path.found) {
      EXPECT_EQ(cost_of(graph, path), path.cost) << trial;
    }
  }
}

// Defect 7: w -> {a .5, b .3, c .2}; a -> {x .5, y .5}; b -> z 1; c -> z 1; closing edges 1.
// Products .25 against .30, reciprocal sums 4.0 against 4.33.
TEST(ClosedPath, OfLeastReciprocalSumIsNotTheMostLikely) {
  auto decode = [](PathCost cost) {
    LayeredGraph graph;
    const std::vector<std::uint8_t> one{0};
    const std::vector<std::uint8_t> three{0, 1, 2};
    graph.add_row(one);
    graph.add_row(three);
    graph.add_row(three);
    graph.finish_rows();
    const double branches[] = {0.5, 0.3, 0.2};
    for (std::size_t i = 0; i < 3; ++i) graph.edge(0, 0, i) = step_cost(branches[i], cost);
    graph.edge(1, 0, 0) = graph.edge(1, 0, 1) = step_cost(0.5, cost);
    graph.edge(1, 1, 2) = graph.edge(1, 2, 2) = step_cost(1.0, cost);
    for (std::size_t i = 0; i < 3; ++i) graph.edge(2, i, 0) = step_cost(1.0, cost);
    graph.start_cost()[0] = step_cost(1.0, cost);
    const ClosedPath path = search_layered(graph);
    EXPECT_EQ(search_dijkstra(graph).states[1], path.states[1]);
    return path;
  };
  const ClosedPath reciprocal = decode(PathCost::kReciprocal);
  EXPECT_EQ(reciprocal.states[1], 0);
  EXPECT_NEAR(reciprocal.cost, 4.0 + 2.0, 1e-12);  // prior and closing edge cost 1 each
  const ClosedPath neglog = decode(PathCost::kNegLog);
  EXPECT_EQ(neglog.states[1], 1);
  EXPECT_NEAR(std::exp(-neglog.cost), 0.30, 1e-12);
}

TEST(StepCost, IsInfiniteForTheImpossible) {
  EXPECT_EQ(step_cost(0.0, PathCost::kReciprocal), kNoEdge);
  EXPECT_EQ(step_cost(0.0, PathCost::kNegLog), kNoEdge);
  EXPECT_EQ(step_cost(1.0, PathCost::kReciprocal), 1.0);
  EXPECT_EQ(step_cost(1.0, PathCost::kNegLog), 0.0);
  EXPECT_FALSE(std::signbit(step_cost(1.0, PathCost::kNegLog)));
}

/// Two angle bins that were seen as (0, 1) three times and as (2, 3) once; a third that was never.
NodeLevel small_level() {
  NodeLevel level({3, 4, 4.0}, 10, false);
  RandomStream random(1, StreamId::kTest);
  constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
  for (int i = 0; i < 3; ++i) level.insert({0.5F, 1.5F, kUnknown}, random);
  level.insert({2.5F, 3.5F, kUnknown}, random);
  return level;
}

TEST(Graph, HasAStatePerRangeBinSeenAndAWildcardWhereNothingWas) {
  const LayeredGraph graph = build_graph(small_level(), exact_decoding());
  EXPECT_THAT(graph.states(0), testing::ElementsAre(0, 2));
  EXPECT_THAT(graph.states(1), testing::ElementsAre(1, 3));
  EXPECT_THAT(graph.states(2), testing::ElementsAre(LayeredGraph::kWildcard));
}

// Defect 6: the text's conditional and the caption's joint weights are different things.
TEST(Graph, WeighsEdgesJointlyConditionallyOrTolerantly) {
  const NodeLevel level = small_level();
  auto weight = [&](const DecodingConfig& config, std::size_t i, std::size_t j) {
    return std::exp(-build_graph(level, config).edges_from(0, i)[j]);
  };
  DecodingConfig config;
  config.edges = EdgeWeight::kConditional;
  EXPECT_NEAR(weight(config, 0, 0), 1.0, 1e-12);
  EXPECT_NEAR(weight(config, 1, 1), 1.0, 1e-12);
  EXPECT_EQ(weight(config, 0, 1), 0.0);
  config.edges = EdgeWeight::kJoint;
  EXPECT_NEAR(weight(config, 0, 0), 0.75, 1e-12);
  EXPECT_NEAR(weight(config, 1, 1), 0.25, 1e-12);
  EXPECT_EQ(weight(config, 0, 1), 0.0);
  config.edges = EdgeWeight::kTolerant;
  // Range bin 0 is beside 1, not beside 2: three pairs count, and kappa pulls to the marginal.
  EXPECT_NEAR(weight(config, 0, 0), (3.0 + 0.1 * 0.75) / 3.1, 1e-12);
  EXPECT_NEAR(weight(config, 0, 1), 0.1 * 0.25 / 3.1, 1e-12);
  EXPECT_NEAR(weight(config, 1, 1), (1.0 + 0.1 * 0.25) / 1.1, 1e-12);
}

TEST(Graph, TakesThePriorFromTheFirstAngleBin) {
  const LayeredGraph graph = build_graph(small_level(), exact_decoding());
  EXPECT_NEAR(std::exp(-graph.start_cost()[0]), 0.75, 1e-12);
  EXPECT_NEAR(std::exp(-graph.start_cost()[1]), 0.25, 1e-12);
}

TEST(Graph, LetsEveryPathThroughAnEmptyAngleBin) {
  DecodingConfig config;
  config.edges = EdgeWeight::kConditional;
  const LayeredGraph conditional = build_graph(small_level(), config);
  EXPECT_EQ(conditional.edges_from(1, 0)[0], 0.0);
  EXPECT_EQ(conditional.edges_from(2, 0)[0], 0.0);
  EXPECT_EQ(conditional.edges_from(2, 0)[1], 0.0);
  // Tolerant weights keep the common state ahead behind the gap.
  const LayeredGraph tolerant = build_graph(small_level(), exact_decoding());
  EXPECT_NEAR(std::exp(-tolerant.edges_from(2, 0)[0]), 0.75, 1e-12);
  EXPECT_NEAR(std::exp(-tolerant.edges_from(2, 0)[1]), 0.25, 1e-12);
}

}  // namespace
}  // namespace strata::memory
