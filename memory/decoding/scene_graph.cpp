// SPDX-License-Identifier: Apache-2.0
#include "memory/decoding/scene_graph.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "memory/decoding/row_counts.hpp"

namespace strata::memory::detail {
namespace {

/// A range that straddles two range bins is in the one as well as in the other.
constexpr double kBeside = 0.5;
/// As a condition the range bin beside counts less: it may belong to another scene.
constexpr double kConditionBeside = 0.2;
/// Prior of "the scene is unknown in the next angle bin", and, to the power of w, in any.
constexpr double kUnseenNext = 0.1;
constexpr double kUnseen = 0.85;

struct Row {
  RowCounts counts;
  std::vector<double> share;   ///< per state
  std::vector<double> weight;  ///< share^w
  double unseen = 1.0;         ///< what a step to the wildcard is worth

  void fill(const NodeLevel& level, int angle_bin, double evidence) {
    counts.fill(level, angle_bin);
    double most = 0.0;
    for (const std::uint8_t state : counts.states) {
      share.push_back(counts.weighted_share(state, kBeside));
      weight.push_back(std::pow(share.back(), evidence));
      most = std::max(most, share.back());
    }
    if (!counts.empty()) unseen = alike() * std::pow(kUnseen * most, evidence);
  }
  [[nodiscard]] std::size_t states() const { return counts.states.size(); }

 private:
  /// Probability that two of the samples lie on one surface: in range bins that touch, as those
  /// of a wall seen askew, or in the same.
  [[nodiscard]] double alike() const {
    double pairs = 0.0;
    double run = 0.0;
    int beyond = -1;
    for (const std::uint8_t state : counts.states) {
      if (state != beyond) {
        pairs += run * run;
        run = 0.0;
      }
      run += counts.count[state];
      beyond = state + 1;
    }
    pairs += run * run;
    return pairs / static_cast<double>(counts.total * counts.total);
  }
};

/// How a state of one row is known to go on in the other row.
struct Known {
  std::vector<double> weight;    ///< pairs of each state, as a condition
  std::vector<double> pairs;     ///< pairs of each state and those beside
  std::vector<double> together;  ///< with a state of the other row

  void start(std::size_t states, std::size_t others) {
    weight.assign(states, 0.0);
    pairs.assign(states, 0.0);
    together.assign(states * others, 0.0);
  }
};

class SceneTable {
 public:
  void fill(const NodeLevel& level, int angle_bin, const Row& from, const Row& to,
            double smoothing) {
    from_ = &from;
    to_ = &to;
    smoothing_ = smoothing;
    pairs_ = static_cast<double>(level.pairs(angle_bin).size());
    const std::size_t width = to.states();
    after_.start(from.states(), width);
    before_.start(width, from.states());
    const auto add = [&](std::uint8_t alpha, std::uint8_t beta, double weight) {
      for_states_near(from.counts, alpha, 1, [&](std::size_t i) {
        const bool is_i = from.counts.states[i] == alpha;
        after_.weight[i] += weight * (is_i ? 1.0 : kConditionBeside);
        after_.pairs[i] += weight;
        for_states_near(to.counts, beta, 1, [&](std::size_t j) {
          const bool is_j = to.counts.states[j] == beta;
          after_.together[i * width + j] +=
              weight * (is_i ? 1.0 : kConditionBeside) * (is_j ? 1.0 : kBeside);
          before_.together[i * width + j] +=
              weight * (is_j ? 1.0 : kConditionBeside) * (is_i ? 1.0 : kBeside);
        });
      });
      for_states_near(to.counts, beta, 1, [&](std::size_t j) {
        before_.weight[j] += weight * (to.counts.states[j] == beta ? 1.0 : kConditionBeside);
        before_.pairs[j] += weight;
      });
    };
    for_each_pair(level, angle_bin, from.counts, to.counts, add);
  }
  /// How much more often the two were seen together than bins that have nothing to do with each
  /// other; at most 1.
  [[nodiscard]] double agreement(std::size_t i, std::size_t j) const {
    const std::size_t both = i * to_->states() + j;
    const double follows = lift(after_.together[both], to_->share[j], after_.weight[i]);
    const double precedes = lift(before_.together[both], from_->share[i], before_.weight[j]);
    return std::min({1.0, follows, precedes});
  }
  /// Whether the scene of state i is unknown in the next row, or that of j in the row before.
  [[nodiscard]] double ends(std::size_t i) const { return unseen_beside(after_, *from_, i); }
  [[nodiscard]] double begins(std::size_t j) const { return unseen_beside(before_, *to_, j); }

 private:
  [[nodiscard]] double lift(double together, double share, double weight) const {
    const double all = weight + smoothing_;
    return all > 0.0 ? (together / share + smoothing_) / all : 1.0;
  }
  [[nodiscard]] double unseen_beside(const Known& known, const Row& row, std::size_t state) const {
    const double all = known.pairs[state] + smoothing_;
    const double contradicted = all > 0.0 ? smoothing_ / all : 1.0;
    // Were the scene known on the other side, this many pairs would be expected.
    const double expected =
        row.share[state] * std::max(pairs_, static_cast<double>(row.counts.total));
    return contradicted / (1.0 + (1.0 - kUnseenNext) / kUnseenNext * std::exp(-expected));
  }

  const Row* from_ = nullptr;
  const Row* to_ = nullptr;
  double smoothing_ = 0.0;
  double pairs_ = 0.0;
  Known after_;   ///< states of `from`
  Known before_;  ///< states of `to`
};

}  // namespace

LayeredGraph build_scene_graph(const NodeLevel& level, const DecodingConfig& config) {
  std::vector<Row> rows(static_cast<std::size_t>(level.bins().angle_bins));
  LayeredGraph graph;
  std::vector<std::uint8_t> states;
  for (std::size_t a = 0; a < rows.size(); ++a) {
    rows[a].fill(level, static_cast<int>(a), config.evidence);
    states = rows[a].counts.states;
    states.push_back(LayeredGraph::kWildcard);
    graph.add_row(states);
  }
  graph.finish_rows();
  SceneTable table;
  for (std::size_t a = 0; a < rows.size(); ++a) {
    const Row& from = rows[a];
    const Row& to = rows[graph.next(a)];
    const bool paired = !from.counts.empty() && !to.counts.empty();
    if (paired) table.fill(level, static_cast<int>(a), from, to, config.smoothing);
    for (std::size_t i = 0; i <= from.states(); ++i) {
      const bool is_from = i < from.states();
      for (std::size_t j = 0; j <= to.states(); ++j) {
        const bool is_to = j < to.states();
        double p = is_to ? to.weight[j] : to.unseen;
        if (paired && is_from && is_to) p *= table.agreement(i, j);
        if (paired && is_from && !is_to) p *= table.ends(i);
        if (paired && !is_from && is_to) p *= table.begins(j);
        graph.edge(a, i, j) = step_cost(p, config.cost);
      }
    }
  }
  return graph;
}

}  // namespace strata::memory::detail
