// SPDX-License-Identifier: Apache-2.0
#include "memory/decoding/graph.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "memory/decoding/row_counts.hpp"
#include "memory/decoding/scene_graph.hpp"

namespace strata::memory {
namespace {

using detail::for_states_near;
using detail::RowCounts;

/// Probabilities of the edges between two rows that both have samples.
class EdgeTable {
 public:
  void fill(const NodeLevel& level, int angle_bin, const RowCounts& from, const RowCounts& to,
            const DecodingConfig& config) {
    const bool tolerant = config.edges == EdgeWeight::kTolerant;
    const int reach = tolerant ? 1 : 0;
    width_ = to.states.size();
    pairs_.assign(from.states.size() * width_, 0.0);
    row_total_.assign(from.states.size(), 0.0);
    detail::for_each_pair(
        level, angle_bin, from, to, [&](std::uint8_t alpha, std::uint8_t beta, double weight) {
          for_states_near(from, alpha, reach, [&](std::size_t i) {
            row_total_[i] += weight;
            for_states_near(to, beta, reach,
                            [&](std::size_t j) { pairs_[i * width_ + j] += weight; });
          });
        });
    const auto all = static_cast<double>(level.pairs(angle_bin).size());
    extra_.clear();
    for (const std::uint8_t bin : to.states) {
      extra_.push_back(tolerant ? config.smoothing * to.smooth_share(bin) : 0.0);
    }
    for (std::size_t i = 0; i < from.states.size(); ++i) {
      for (std::size_t j = 0; j < width_; ++j) {
        double& p = pairs_[i * width_ + j];
        if (tolerant) {
          p = ratio(p + extra_[j], row_total_[i] + config.smoothing);
        } else {
          p = ratio(p, config.edges == EdgeWeight::kJoint ? all : row_total_[i]);
        }
      }
    }
  }
  [[nodiscard]] double probability(std::size_t i, std::size_t j) const {
    return pairs_[i * width_ + j];
  }

 private:
  static double ratio(double part, double whole) {
    return whole > 0.0 ? std::min(1.0, part / whole) : 0.0;
  }
  std::size_t width_ = 0;
  std::vector<double> pairs_;
  std::vector<double> row_total_;
  std::vector<double> extra_;  ///< kappa times the share of each target state
};

}  // namespace

double step_cost(double probability, PathCost cost) {
  if (probability <= 0.0) return kNoEdge;
  // -ln 1 is -0.0; keep costs free of negative zeros.
  return cost == PathCost::kReciprocal ? 1.0 / probability : 0.0 - std::log(probability);
}

void LayeredGraph::add_row(std::span<const std::uint8_t> range_bins) {
  range_bin_.insert(range_bin_.end(), range_bins.begin(), range_bins.end());
  state_begin_.push_back(range_bin_.size());
}

void LayeredGraph::finish_rows() {
  std::size_t edges = 0;
  edge_begin_.clear();
  for (std::size_t row = 0; row < rows(); ++row) {
    edge_begin_.push_back(edges);
    edges += states(row).size() * states(next(row)).size();
  }
  edge_cost_.assign(edges, kNoEdge);
  start_cost_.assign(states(0).size(), 0.0);
}

LayeredGraph build_graph(const NodeLevel& level, const DecodingConfig& config) {
  if (config.edges == EdgeWeight::kScene) return detail::build_scene_graph(level, config);
  const int rows = level.bins().angle_bins;
  std::vector<RowCounts> counts(static_cast<std::size_t>(rows));
  LayeredGraph graph;
  constexpr std::array<std::uint8_t, 1> kWildcardRow{LayeredGraph::kWildcard};
  for (int a = 0; a < rows; ++a) {
    RowCounts& row = counts[static_cast<std::size_t>(a)];
    row.fill(level, a);
    graph.add_row(row.empty() ? std::span<const std::uint8_t>(kWildcardRow) : row.states);
  }
  graph.finish_rows();
  const double certain = step_cost(1.0, config.cost);
  for (std::size_t i = 0; i < graph.states(0).size(); ++i) {
    const RowCounts& row = counts[0];
    const double share =
        row.empty() ? 1.0 : row.count[row.states[i]] / static_cast<double>(row.total);
    graph.start_cost()[i] = step_cost(share, config.cost);
  }
  EdgeTable table;
  for (std::size_t a = 0; a < counts.size(); ++a) {
    const RowCounts& from = counts[a];
    const RowCounts& to = counts[graph.next(a)];
    const bool paired = !from.empty() && !to.empty();
    if (paired) table.fill(level, static_cast<int>(a), from, to, config);
    for (std::size_t i = 0; i < graph.states(a).size(); ++i) {
      for (std::size_t j = 0; j < graph.states(graph.next(a)).size(); ++j) {
        double& edge = graph.edge(a, i, j);
        if (paired) {
          edge = step_cost(table.probability(i, j), config.cost);
        } else if (!to.empty() && config.edges == EdgeWeight::kTolerant) {
          // Behind a gap the common state wins, not any state.
          edge = step_cost(std::min(1.0, to.smooth_share(to.states[j])), config.cost);
        } else {
          edge = certain;
        }
      }
    }
  }
  return graph;
}

}  // namespace strata::memory
