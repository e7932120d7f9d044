// SPDX-License-Identifier: Apache-2.0
/// Which time level to believe where: per node a weight for each level, learned while localizing.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "memory/nodes/node_map.hpp"

namespace strata::memory {

/// How the weights follow what is seen.
struct LevelMixtureConfig {
  double forgetting = 0.02;       ///< share of the weight that goes back to the start each update
  double effective_beams = 10.0;  ///< beams of one scan are not independent
  /// Weight that each level but the slowest starts with. A fast level is right only where what was
  /// last seen is still so, which it has to show by predicting scans that it has not learned yet.
  double unearned = 0.005;

  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("forgetting", c.forgetting,
            {.doc = "share of the weights that goes back to the start at each update",
             .min = 0.0,
             .max = 1.0});
    v.field("effective_beams", c.effective_beams,
            {.doc = "a scan counts as this many independent beams", .min = 0.1});
    v.field("unearned", c.unearned,
            {.doc = "weight that each level but the slowest starts with, a share of an even one at "
                    "most",
             .min = 0.0,
             .max = 1.0});
  }
};

/// A forgetting Bayes mixture per node: w_l <- (1 - forgetting) w_l L_l / sum + forgetting s_l,
/// with L_l the likelihood of a scan under level l, and s_l the weights that nodes start with: the
/// last level, which forgets most slowly, has what the others do not. One thread at a time.
class LevelMixture {
 public:
  LevelMixture(const LevelMixtureConfig& config, std::size_t levels);

  /// One weight per level; sums to 1.
  [[nodiscard]] std::span<const double> weights(int node) const;

  /// The node whose weights hold at a place: the nearest that sees it in any level; -1 for none.
  [[nodiscard]] static int node_at(const NodeMap& map, const Eigen::Vector2d& point_m);

  /// Takes over the weights of the nodes that are at the same places in both maps; this mixture is
  /// for `map`, `before` for `map_before`. Nothing when their levels differ in number.
  void adopt(const LevelMixture& before, const NodeMap& map_before, const NodeMap& map);

  /// Learns from how well each level predicted a scan, taken where the weights of the node hold:
  /// ln p of a beam in the mean. Nothing for node -1. Allocates only when a node is met for the
  /// first time.
  void update(int node, std::span<const double> log_p_a_beam);

  /// For saved states.
  template <class Self, class Archive>
  static void state(Self& self, Archive& archive) {
    archive(self.weights_);
    if constexpr (Archive::kReads) {
      for (const std::vector<double>& row : self.weights_) {
        if (row.size() != self.start_.size()) archive.fail("has another number of levels");
      }
    }
  }

 private:
  LevelMixtureConfig config_;
  std::vector<double> start_;
  std::vector<std::vector<double>> weights_;  ///< per node
  std::vector<double> score_;                 ///< kept for its memory
};

}  // namespace strata::memory
