// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "memory/decoding/graph.hpp"

namespace strata::memory {
namespace {

std::size_t narrowest_row(const LayeredGraph& graph) {
  std::size_t best = 0;
  for (std::size_t row = 1; row < graph.rows(); ++row) {
    if (graph.states(row).size() < graph.states(best).size()) best = row;
  }
  return best;
}

/// The prior belongs to the state in row 0, wherever the walk begins.
double prior_cost(const LayeredGraph& graph, std::size_t row, std::size_t state) {
  return row == 0 ? graph.start_cost()[state] : 0.0;
}

/// One step for all starts at once: to[j][s] = min over i of from[i][s] + edge(i, j).
/// The starts lie side by side, so that the compiler makes vector code of the inner loop.
void relax_row(const LayeredGraph& graph, std::size_t row, std::size_t starts,
               const std::vector<double>& from, std::vector<double>& to) {
  const std::size_t next = graph.next(row);
  const std::size_t width = graph.states(next).size();
  to.assign(width * starts, kNoEdge);
  for (std::size_t i = 0; i < graph.states(row).size(); ++i) {
    const std::span<const double> edges = graph.edges_from(row, i);
    const double* const source = from.data() + i * starts;
    for (std::size_t j = 0; j < width; ++j) {
      const double edge = edges[j] + prior_cost(graph, next, j);
      if (edge == kNoEdge) continue;
      double* const target = to.data() + j * starts;
      for (std::size_t s = 0; s < starts; ++s) {
        const double cost = source[s] + edge;
        target[s] = cost < target[s] ? cost : target[s];
      }
    }
  }
}

/// The cheapest closed path through one state, walked again with the way back noted.
ClosedPath trace(const LayeredGraph& graph, std::size_t first_row, std::size_t start) {
  const std::size_t rows = graph.rows();
  std::vector<double> from(graph.states(first_row).size(), kNoEdge);
  from[start] = 0.0;
  std::vector<double> to;
  std::vector<std::vector<std::uint8_t>> back(rows);
  for (std::size_t step = 0; step < rows; ++step) {
    const std::size_t row = (first_row + step) % rows;
    const std::size_t next = graph.next(row);
    to.assign(graph.states(next).size(), kNoEdge);
    back[step].assign(to.size(), 0);
    for (std::size_t i = 0; i < from.size(); ++i) {
      const std::span<const double> edges = graph.edges_from(row, i);
      for (std::size_t j = 0; j < to.size(); ++j) {
        const double cost = from[i] + (edges[j] + prior_cost(graph, next, j));
        if (cost < to[j]) {
          to[j] = cost;
          back[step][j] = static_cast<std::uint8_t>(i);
        }
      }
    }
    std::swap(from, to);
  }
  ClosedPath path;
  path.cost = from[start];
  path.found = path.cost < kNoEdge;
  path.states.resize(rows);
  std::size_t state = start;
  for (std::size_t step = rows; step-- > 0;) {
    state = back[step][state];
    path.states[(first_row + step) % rows] = static_cast<std::uint8_t>(state);
  }
  return path;
}

}  // namespace

ClosedPath search_layered(const LayeredGraph& graph) {
  const std::size_t rows = graph.rows();
  const std::size_t first_row = narrowest_row(graph);
  const std::size_t starts = graph.states(first_row).size();
  std::vector<double> from(starts * starts, kNoEdge);
  for (std::size_t s = 0; s < starts; ++s) from[s * starts + s] = 0.0;
  std::vector<double> to;
  for (std::size_t step = 0; step < rows; ++step) {
    relax_row(graph, (first_row + step) % rows, starts, from, to);
    std::swap(from, to);
  }
  std::size_t best = 0;
  for (std::size_t s = 1; s < starts; ++s) {
    if (from[s * starts + s] < from[best * starts + best]) best = s;
  }
  if (from[best * starts + best] == kNoEdge) return {};
  return trace(graph, first_row, best);
}

}  // namespace strata::memory
