// SPDX-License-Identifier: Apache-2.0
/// Dijkstra's algorithm as in the textbook, one full search a start: what the decoder's own form is
/// tested against and timed beside.
#pragma once

#include <functional>
#include <queue>
#include <tuple>

#include "memory/decoding/graph.hpp"

namespace strata::memory::textbook {

/// Row `rows()` is the copy of row 0 where a path must end as it began.
class DijkstraSearch {
 public:
  explicit DijkstraSearch(const LayeredGraph& graph) : graph_(graph) {
    first_.push_back(0);
    for (std::size_t row = 0; row <= graph.rows(); ++row) {
      first_.push_back(first_.back() + states(row));
    }
  }

  /// Cost of the cheapest path from the start to its copy; kNoEdge for none.
  double run(std::size_t start) {
    cost_.assign(first_.back(), kNoEdge);
    back_.assign(first_.back(), 0);
    using Entry = std::tuple<double, std::size_t, std::size_t>;  // cost, row, state
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
    cost_[start] = graph_.start_cost()[start];
    open.emplace(cost_[start], 0, start);
    while (!open.empty()) {
      const auto [cost, row, state] = open.top();
      open.pop();
      if (cost > cost_[first_[row] + state]) continue;
      if (row == graph_.rows()) {
        if (state == start) return cost;
        continue;
      }
      const std::span<const double> edges = graph_.edges_from(row, state);
      for (std::size_t j = 0; j < edges.size(); ++j) {
        const std::size_t target = first_[row + 1] + j;
        if (cost + edges[j] < cost_[target]) {
          cost_[target] = cost + edges[j];
          back_[target] = static_cast<std::uint8_t>(state);
          open.emplace(cost_[target], row + 1, j);
        }
      }
    }
    return kNoEdge;
  }

  /// The states of the last run's path, rows 0 to rows() - 1.
  [[nodiscard]] std::vector<std::uint8_t> path_to(std::size_t state) const {
    std::vector<std::uint8_t> path(graph_.rows());
    for (std::size_t row = graph_.rows(); row-- > 0;) {
      state = back_[first_[row + 1] + state];
      path[row] = static_cast<std::uint8_t>(state);
    }
    return path;
  }

 private:
  [[nodiscard]] std::size_t states(std::size_t row) const {
    return graph_.states(row == graph_.rows() ? 0 : row).size();
  }
  const LayeredGraph& graph_;
  std::vector<std::size_t> first_;
  std::vector<double> cost_;
  std::vector<std::uint8_t> back_;
};

inline ClosedPath search_dijkstra(const LayeredGraph& graph) {
  DijkstraSearch search(graph);
  ClosedPath best;
  for (std::size_t start = 0; start < graph.states(0).size(); ++start) {
    if (graph.start_cost()[start] == kNoEdge) continue;
    const double cost = search.run(start);
    if (cost < best.cost) best = {true, cost, search.path_to(start)};
  }
  return best;
}

}  // namespace strata::memory::textbook
