// SPDX-License-Identifier: Apache-2.0
/// Which time level to believe where: per node a weight for each level, learned while localizing.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/geometry/pose2.hpp"
#include "core/scan/scan.hpp"
#include "memory/nodes/node_map.hpp"

namespace strata::memory {

/// How the weights follow what is seen.
struct LevelMixtureConfig {
  double forgetting = 0.02;       ///< share of the weight that is spread evenly at each update
  double sigma_m = 0.1;           ///< spread of a range about the expected one
  double hit = 0.85;              ///< share of readings that agree with the level
  double effective_beams = 10.0;  ///< beams of one scan are not independent

  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("forgetting", c.forgetting,
            {.doc = "share of the weights spread evenly at each update", .min = 0.0, .max = 1.0});
    v.field("sigma_m", c.sigma_m,
            {.doc = "spread of a range about the expected one", .unit = "m", .min = 1e-3});
    v.field("hit", c.hit,
            {.doc = "share of readings that agree with the level", .min = 0.0, .max = 0.999});
    v.field("effective_beams", c.effective_beams,
            {.doc = "a scan counts as this many independent beams", .min = 0.1});
  }
};

/// A forgetting Bayes mixture per node: w_l <- (1 - forgetting) w_l L_l / sum + forgetting /
/// levels, with L_l the likelihood of the scan under level l. New nodes start even. One thread at a
/// time.
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

  /// Learns from a scan taken at a known pose; uses at most 60 of its beams. Returns the node whose
  /// weights changed, -1 for none. Allocates only when a node is met for the first time, or a scan
  /// has more beams than any before.
  int update(const NodeMap& map, const Pose2& map_from_laser, const Scan& scan);

  /// For saved states.
  template <class Self, class Archive>
  static void state(Self& self, Archive& archive) {
    archive(self.weights_);
    if constexpr (Archive::kReads) {
      for (const std::vector<double>& row : self.weights_) {
        if (row.size() != self.even_.size()) archive.fail("has another number of levels");
      }
    }
  }

 private:
  [[nodiscard]] double log_likelihood(std::span<const float> expected_m,
                                      std::span<const float> measured_m, double max_m) const;

  LevelMixtureConfig config_;
  std::vector<double> even_;
  std::vector<std::vector<double>> weights_;  ///< per node
  struct Scratch {
    std::vector<double> bearings_rad;
    std::vector<float> measured_m;
    std::vector<float> expected_m;
    std::vector<double> score;
  };
  Scratch scratch_;
};

}  // namespace strata::memory
