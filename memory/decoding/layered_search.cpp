// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "memory/decoding/graph.hpp"
#include "memory/decoding/relax_kernel.hpp"

namespace strata::memory {
namespace {

std::size_t narrowest_row(const LayeredGraph& graph) {
  std::size_t best = 0;
  for (std::size_t row = 1; row < graph.rows(); ++row) {
    if (graph.states(row).size() < graph.states(best).size()) best = row;
  }
  return best;
}

/// Edge costs from a row to the next, with the prior of the state they lead to.
std::span<const double> step_costs(const LayeredGraph& graph, std::size_t row,
                                   std::vector<double>& scratch) {
  const std::span<const double> first = graph.edges_from(row, 0);
  const std::size_t width = first.size();
  const std::size_t states = graph.states(row).size();
  if (graph.next(row) != 0) return {first.data(), states * width};
  scratch.assign(first.data(), first.data() + states * width);
  for (std::size_t i = 0; i < states; ++i) {
    for (std::size_t j = 0; j < width; ++j) scratch[i * width + j] += graph.start_cost()[j];
  }
  return scratch;
}

/// Costs of all states of all rows from all starts; those of one state lie side by side.
struct CostTable {
  std::size_t stride = 0;
  std::vector<std::size_t> begin;  ///< of each step's row; one more than rows
  std::vector<double> cost;

  CostTable(const LayeredGraph& graph, std::size_t first_row) {
    const std::size_t rows = graph.rows();
    const std::size_t starts = graph.states(first_row).size();
    stride = (starts + detail::kStartLanes - 1) / detail::kStartLanes * detail::kStartLanes;
    begin.push_back(0);
    for (std::size_t step = 0; step <= rows; ++step) {
      const std::size_t width = graph.states((first_row + step) % rows).size();
      begin.push_back(begin.back() + width * stride);
    }
    cost.resize(begin.back());
    // Every start costs nothing for itself; padded starts are never reached.
    std::fill_n(cost.begin(), begin[1], kNoEdge);
    for (std::size_t s = 0; s < starts; ++s) cost[s * stride + s] = 0.0;
  }
  [[nodiscard]] double* row(std::size_t step) { return cost.data() + begin[step]; }
};

/// Finds the way back to the start: at each step the first state that explains the cost exactly.
std::vector<std::uint8_t> trace(const LayeredGraph& graph, CostTable& table, std::size_t first_row,
                                std::size_t start) {
  const std::size_t rows = graph.rows();
  std::vector<std::uint8_t> states(rows);
  std::vector<double> scratch;
  std::size_t state = start;
  for (std::size_t step = rows; step-- > 0;) {
    const std::size_t row = (first_row + step) % rows;
    const std::span<const double> edges = step_costs(graph, row, scratch);
    const std::size_t width = graph.states(graph.next(row)).size();
    const double* const from = table.row(step);
    const double cost = table.row(step + 1)[state * table.stride + start];
    std::size_t i = 0;
    while (from[i * table.stride + start] + edges[i * width + state] != cost) ++i;
    state = i;
    states[row] = static_cast<std::uint8_t>(state);
  }
  return states;
}

}  // namespace

ClosedPath search_layered(const LayeredGraph& graph) {
  const std::size_t rows = graph.rows();
  const std::size_t first_row = narrowest_row(graph);
  CostTable table(graph, first_row);
  std::vector<double> scratch;
  for (std::size_t step = 0; step < rows; ++step) {
    const std::size_t row = (first_row + step) % rows;
    detail::relax(table.row(step), step_costs(graph, row, scratch).data(), graph.states(row).size(),
                  graph.states(graph.next(row)).size(), table.stride, table.row(step + 1));
  }
  const double* const last = table.row(rows);
  std::size_t best = 0;
  for (std::size_t s = 1; s < graph.states(first_row).size(); ++s) {
    if (last[s * table.stride + s] < last[best * table.stride + best]) best = s;
  }
  const double cost = last[best * table.stride + best];
  if (cost == kNoEdge) return {};
  return {true, cost, trace(graph, table, first_row, best)};
}

}  // namespace strata::memory
