// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <functional>
#include <numeric>

#include "memory/decoding/graph.hpp"

namespace strata::memory {
namespace {

/// Row `rows()` is the copy of row 0 where a path must end as it began.
class DijkstraSearch {
 public:
  explicit DijkstraSearch(const LayeredGraph& graph) : graph_(graph) {
    first_.push_back(0);
    for (std::size_t row = 0; row <= graph.rows(); ++row) {
      first_.push_back(first_.back() + states(row));
    }
    bound_costs_to_go();
  }

  /// Starts that have a prior, the most promising first.
  [[nodiscard]] std::vector<std::size_t> starts() const {
    std::vector<std::size_t> order(states(0));
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [this](std::size_t a, std::size_t b) { return bound(a) < bound(b); });
    return order;
  }
  /// No path from the start is cheaper.
  [[nodiscard]] double bound(std::size_t start) const {
    return graph_.start_cost()[start] + to_go_[start];
  }

  /// Cost of the cheapest path from the start to its copy; kNoEdge when none is below `limit`.
  double run(std::size_t start, double limit) {
    cost_.assign(first_.back(), kNoEdge);
    back_.resize(first_.back());
    open_.clear();
    cost_[start] = graph_.start_cost()[start];
    push({bound(start), 0, start, cost_[start]});
    while (!open_.empty() && open_.front().estimate < limit) {
      const Entry entry = pop();
      const std::size_t row = entry.row;
      if (entry.cost > cost_[first_[row] + entry.state]) continue;
      if (row == graph_.rows()) return entry.cost;
      const std::span<const double> edges = graph_.edges_from(row, entry.state);
      const bool is_last = row + 1 == graph_.rows();
      for (std::size_t j = 0; j < edges.size(); ++j) {
        if (is_last && j != start) continue;
        const std::size_t target = first_[row + 1] + j;
        const double cost = entry.cost + edges[j];
        if (!(cost < cost_[target]) || !(cost + to_go_[target] < limit)) continue;
        cost_[target] = cost;
        back_[target] = static_cast<std::uint8_t>(entry.state);
        push({cost + to_go_[target], row + 1, j, cost});
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
  struct Entry {
    double estimate = 0.0;  ///< cost and the least that is to come
    std::size_t row = 0;
    std::size_t state = 0;
    double cost = 0.0;
    bool operator>(const Entry& other) const {
      // Of equal estimates the one that has come further: it is nearest to an end.
      return estimate != other.estimate ? estimate > other.estimate : row < other.row;
    }
  };
  void push(const Entry& entry) {
    open_.push_back(entry);
    std::push_heap(open_.begin(), open_.end(), std::greater<>());
  }
  Entry pop() {
    std::pop_heap(open_.begin(), open_.end(), std::greater<>());
    const Entry entry = open_.back();
    open_.pop_back();
    return entry;
  }
  /// From every state to the nearest state of the last row, whichever that is.
  void bound_costs_to_go() {
    to_go_.assign(first_.back(), 0.0);
    for (std::size_t row = graph_.rows(); row-- > 0;) {
      for (std::size_t i = 0; i < states(row); ++i) {
        double least = kNoEdge;
        const std::span<const double> edges = graph_.edges_from(row, i);
        for (std::size_t j = 0; j < edges.size(); ++j) {
          least = std::min(least, edges[j] + to_go_[first_[row + 1] + j]);
        }
        to_go_[first_[row] + i] = least;
      }
    }
  }
  [[nodiscard]] std::size_t states(std::size_t row) const {
    return graph_.states(row == graph_.rows() ? 0 : row).size();
  }

  const LayeredGraph& graph_;
  std::vector<std::size_t> first_;
  std::vector<double> to_go_;
  std::vector<double> cost_;
  std::vector<std::uint8_t> back_;
  std::vector<Entry> open_;
};

}  // namespace

ClosedPath search_dijkstra(const LayeredGraph& graph) {
  DijkstraSearch search(graph);
  ClosedPath best;
  for (const std::size_t start : search.starts()) {
    if (!(search.bound(start) < best.cost)) break;
    const double cost = search.run(start, best.cost);
    if (cost < best.cost) best = {true, cost, search.path_to(start)};
  }
  return best;
}

}  // namespace strata::memory
