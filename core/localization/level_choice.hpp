// SPDX-License-Identifier: Apache-2.0
/// On which level of a building a robot is, by what its scans are worth on each
/// (docs/theory/levels.md).
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "core/base/config.hpp"

namespace strata::localization {

struct LevelChoiceConfig {
  double refuted_nats = 3.0;
  double max_nats = 12.0;
  double memory_s = 2.0;
  double search_memory_s = 5.0;
  double min_score = 0.6;
  double watched_m = 10.0;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("refuted_nats", c.refuted_nats,
            {.doc = "a level is refuted when scans are on average so much less likely there than "
                    "on another level; one is believed when all others are refuted",
             .unit = "nats",
             .min = 0.01});
    v.field("max_nats", c.max_nats,
            {.doc = "one scan speaks against a level by no more than this",
             .unit = "nats",
             .min = 0.01});
    v.field("memory_s", c.memory_s,
            {.doc = "the average forgets with this time constant, in a lift and after it",
             .unit = "s",
             .min = 0.05});
    v.field("search_memory_s", c.search_memory_s,
            {.doc = "... while a robot is looked for on all levels", .unit = "s", .min = 0.05});
    v.field("min_score", c.min_score,
            {.doc = "no level is believed while the score of the pose on it is lower",
             .unit = "1",
             .min = 0.0,
             .max = 1.0});
    v.field("watched_m", c.watched_m,
            {.doc = "after a lift the other levels are looked at for so long a way, and taken when "
                    "they refute the one believed",
             .unit = "m",
             .min = 0.0});
    v.require(c.refuted_nats <= c.max_nats, "refuted_nats", "is above max_nats", "lower it");
  }
};

/// A running average of ln p(scan | level), less that of the best level. Averages do not add up:
/// what two maps of floors that look alike differ by in each scan does not become a proof.
class LevelChoice {
 public:
  explicit LevelChoice(const LevelChoiceConfig& config) : config_(config) {}

  /// `count` levels may be it; `believed` was known until now, and has refuted the others.
  void begin(std::size_t count, std::optional<std::size_t> believed);
  /// One more, which the leading one has refuted.
  void add_level() { average_.push_back(average_[leading_] - kKnown * config_.refuted_nats); }
  /// One scan. log_likelihood: one a level, up to a constant that all share [nats].
  void weigh(std::span<const double> log_likelihood, double elapsed_s, double memory_s);

  [[nodiscard]] std::size_t size() const { return average_.size(); }
  /// Another one takes its place when it refutes it.
  [[nodiscard]] std::size_t leading() const { return leading_; }
  /// By how much the leading one is ahead of the best other one; +infinity without others [nats].
  [[nodiscard]] double lead_nats() const;
  [[nodiscard]] bool is_decided() const { return lead_nats() >= config_.refuted_nats; }
  /// For people: 1% where a level is just refuted. Sums to 1.
  [[nodiscard]] std::vector<double> probabilities() const;

 private:
  /// What was known is forgotten about as fast as what was seen.
  static constexpr double kKnown = 2.0;

  LevelChoiceConfig config_;
  std::vector<double> average_;
  std::size_t leading_ = 0;
};

}  // namespace strata::localization
