// SPDX-License-Identifier: Apache-2.0
/// The graph whose cheapest closed path is the decoded scan [kessler2010what, figure 5].
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "memory/decoding/decoding_config.hpp"
#include "memory/levels/node_level.hpp"

namespace strata::memory {

inline constexpr double kNoEdge = std::numeric_limits<double>::infinity();

/// Cost of a step of probability p: 1/p or -ln p; kNoEdge for p = 0.
[[nodiscard]] double step_cost(double probability, PathCost cost);

/// One row per angle bin; its states are the range bins that have samples. A row without samples
/// has one wildcard state: all its range bins are possible and equal (the paper's exception), so
/// one stands for all. Edges lead from each row to the next and from the last to the first.
class LayeredGraph {
 public:
  /// State of a row without samples; in scene graphs of every row with samples too.
  static constexpr std::uint8_t kWildcard = 255;

  /// Appends a row; its states are numbered from 0. Requires at least one state.
  void add_row(std::span<const std::uint8_t> range_bins);
  /// After the last add_row: makes room for the edges, all kNoEdge, and start costs, all 0.
  void finish_rows();

  [[nodiscard]] std::size_t rows() const { return state_begin_.size() - 1; }
  [[nodiscard]] std::size_t next(std::size_t row) const { return row + 1 == rows() ? 0 : row + 1; }
  [[nodiscard]] std::span<const std::uint8_t> states(std::size_t row) const {
    return {range_bin_.data() + state_begin_[row], state_begin_[row + 1] - state_begin_[row]};
  }
  /// Costs from state i of the row to each state of the next row.
  [[nodiscard]] std::span<const double> edges_from(std::size_t row, std::size_t i) const {
    const std::size_t width = states(next(row)).size();
    return {edge_cost_.data() + edge_begin_[row] + i * width, width};
  }
  [[nodiscard]] double& edge(std::size_t row, std::size_t i, std::size_t j) {
    return edge_cost_[edge_begin_[row] + i * states(next(row)).size() + j];
  }
  /// Cost of the prior, per state of row 0.
  [[nodiscard]] std::span<const double> start_cost() const { return start_cost_; }
  [[nodiscard]] std::span<double> start_cost() { return start_cost_; }

 private:
  std::vector<std::size_t> state_begin_{0};
  std::vector<std::uint8_t> range_bin_;
  std::vector<std::size_t> edge_begin_;
  std::vector<double> edge_cost_;
  std::vector<double> start_cost_;
};

/// The graph of a level's counts. O(angle bins x (pairs + states^2)).
[[nodiscard]] LayeredGraph build_graph(const NodeLevel& level, const DecodingConfig& config);

/// A closed path: one state per row.
struct ClosedPath {
  bool found = false;
  double cost = kNoEdge;  ///< prior, all edges and the closing edge
  std::vector<std::uint8_t> states;
};

/// Cheapest closed path by dynamic programming. A closed path costs the same wherever one starts to
/// walk it, so this starts in the row with fewest states, S of them: O(S x edges).
[[nodiscard]] ClosedPath search_layered(const LayeredGraph& graph);
/// Cheapest closed path by one Dijkstra search per state of row 0, as the paper does, with two
/// things on top that leave the result as it is. Costs are reduced by what is at least to come (A*
/// with consistent potentials [hart1968formal]): the way on to any state of the last row, found
/// once for all starts by going through the rows backwards. And starts come in the order of that
/// bound and end where they can no longer undercut the best one so far. O(starts x edges x log
/// states) at worst, usually O(edges). The same cost up to rounding.
[[nodiscard]] ClosedPath search_dijkstra(const LayeredGraph& graph);

}  // namespace strata::memory
