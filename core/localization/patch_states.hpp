// SPDX-License-Identifier: Apache-2.0
/// What particles know of the configurations of sub-maps, and how that changes with time.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "core/base/config.hpp"
#include "core/base/parallel.hpp"
#include "core/localization/object_pool.hpp"
#include "core/localization/particle_set.hpp"
#include "core/patch/chain.hpp"
#include "core/patch/patch_map.hpp"
#include "core/random/stream.hpp"

namespace strata::localization {

/// What is kept of other sub-maps (docs/theory/patch_localization.md, "Memory of sub-maps").
enum class PatchMemory {
  kNone,         ///< the paper: a particle holds one configuration, of the sub-map it entered
  kShared,       ///< one belief per sub-map for all particles
  kPerParticle,  ///< a belief per particle and sub-map (factored posterior)
};

/// Where rates of change come from (docs/theory/patch_localization.md, "Rates of change").
enum class RateSource {
  kFixed,    ///< one rate for every sub-map, and no configuration is more usual than another
  kLearned,  ///< the chain of each sub-map, as it was learned with the map
};

struct PatchStatesConfig {
  PatchMemory memory = PatchMemory::kPerParticle;
  RateSource rates = RateSource::kLearned;
  double forgetting_rate_per_s = 1.0 / 600.0;
  double min_belief = 1e-3;
  double shared_max_stddev_m = 0.3;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field(
        "memory", c.memory,
        {.doc = "what is kept of sub-maps the robot has left", .preset = {"paper-patch", "none"}});
    v.field(
        "forgetting_rate_per_s", c.forgetting_rate_per_s,
        {.doc = "rates fixed: gamma at which a known configuration becomes unknown",
         .unit = "1/s",
         .min = 0.0,
         .when = "rates is fixed, and doors and furniture move more often, or more seldom, than "
                 "every ten minutes"});
    v.field("rates", c.rates,
            {.doc = "learned: what is known of a sub-map fades to how often each configuration is "
                    "there, at the rate that was learned with the map; fixed: to even odds, at "
                    "forgetting_rate_per_s",
             .preset = {"paper-patch", "fixed"}});
    v.removed("prior_changes", "it is chain.prior_changes when learning");
    v.removed("prior_hours", "it is chain.prior_hours when learning");
    v.renamed("least_belief", "min_belief");
    v.field("min_belief", c.min_belief,
            {.doc = "no configuration's probability falls below", .min = 0.0, .max = 0.1});
    v.removed("reach_m", "it is where sequences begin (sequences.entry_margin_m when learning)");
    v.field("shared_max_stddev_m", c.shared_max_stddev_m,
            {.doc = "shared beliefs learn only while the pose is at least this certain",
             .unit = "m",
             .min = 0.0});
  }
};

/// The posterior over the configurations of one sub-map.
struct SubmapBelief {
  int submap = -1;
  double mass = 0.0;                ///< weight of the particles whose sub-map it is (submap_of)
  std::vector<double> probability;  ///< per configuration; what is left to 1 is something else
};

/// P(same after dt) of the K-state chain that leaves at rate q = gamma (K-1)/K: 1/K + (1 - 1/K)
/// exp(-gamma dt) (docs/theory/patch_localization.md, "Patch transition"); 1 for K = 1.
[[nodiscard]] double stay_probability(int configurations, double gamma_per_s, double dt_s);

/// What the filter takes from a sub-map's chain: the shares of its configurations, none below
/// `min_share`, and the rate. A map that came without a rate has its sequences asked; one whose
/// priors are no shares has even odds. What such a sub-map's shares are by the time is then asked
/// of its sequences too; where they do not depend on it `in_time` is not periodic. O(sequences x
/// 40).
struct FilterChain {
  patch::Chain chain;
  periodic::PeriodicShares in_time;
};
[[nodiscard]] FilterChain chain_of(const patch::Submap& submap, double min_share);

/// For each sub-map, how probably something is there that none of its configurations shows, before
/// anybody looks (docs/theory/patch_localization.md, "Something else"); 0 where nobody knows what
/// came back. O(sequences x configurations).
[[nodiscard]] std::vector<double> shares_of_something_else(const patch::PatchMap& map);

/// The layout of the beliefs of a patch map, and the map transition p(m_t | x_t, m_{t-1}) of
/// [stachniss2005patch, eq. (8)].
class PatchStates {
 public:
  /// Throws InputError when a sub-map has no configuration or more than 64.
  PatchStates(std::shared_ptr<const patch::PatchMap> map, const PatchStatesConfig& config);

  [[nodiscard]] const patch::PatchMap& map() const { return *map_; }
  [[nodiscard]] PatchMemory memory() const { return config_.memory; }
  [[nodiscard]] double min_belief() const { return config_.min_belief; }
  [[nodiscard]] std::size_t submaps() const { return rates_.size(); }
  /// Columns of one belief row; those of sub-map s are [offset(s), offset(s) + count(s)).
  [[nodiscard]] std::size_t columns() const { return usual_.size(); }
  [[nodiscard]] std::size_t offset(std::size_t submap) const { return offsets_[submap]; }
  [[nodiscard]] int count(std::size_t submap) const {
    return static_cast<int>(offsets_[submap + 1] - offsets_[submap]);
  }
  /// How probably none of its configurations is there, for someone who saw nothing. A row's columns
  /// of that sub-map sum to 1 less what it believes of that. 0 without a memory for each particle,
  /// and where rates are fixed.
  [[nodiscard]] float something_else(std::size_t submap) const { return something_else_[submap]; }
  [[nodiscard]] bool expects_something_else() const { return expects_something_else_; }
  /// The belief of someone who saw nothing: how often each configuration is there, or even odds
  /// where rates are fixed.
  [[nodiscard]] std::span<const float> usual() const { return usual_; }
  /// The same at the time that the particles were told.
  [[nodiscard]] std::span<const float> usual(const ParticleSet& particles) const {
    return particles.usual.empty() ? usual() : std::span<const float>(particles.usual);
  }
  /// Whether what is usual of any sub-map follows the time of day or week.
  [[nodiscard]] bool follows_time() const { return !followed_.empty(); }
  /// What is usual at that time becomes what the particles believe of what they do not see, as they
  /// forget. O(columns x harmonics); nothing where no sub-map follows the time.
  void tell_time(Stamp now, ParticleSet& particles) const;

  /// The sub-map of a robot at a point, -1 for none: with memory the one it stands in (the rule for
  /// overlaps); without, the one whose configuration a particle holds there, entered from
  /// PatchMap::entry_margin_m around it: a door is seen from the corridor, whose middle its
  /// rectangle may not hold (docs/theory/patch_localization.md, "Patch transition").
  [[nodiscard]] int submap_of(const Eigen::Vector2d& point_m, int current = -1) const;
  /// Gives the set the columns it needs and forgets everything but the time.
  void prepare(ParticleSet& particles) const;
  /// Particle i knows nothing: its sub-map from its pose, its configuration (without memory) drawn
  /// from usual(), its belief that.
  /// current: the sub-map it is believed to be in already, -1 for none.
  void draw(ParticleSet& particles, std::size_t i, RandomStream& random, int current = -1) const;
  /// Takes particles over from a model with the states `before` (null: none). A sub-map descends
  /// from the old one that it has most cells in common with, if these are more than half of the
  /// smaller of both. What was believed of an old configuration goes to the new one that looks most
  /// like it there, or in equal parts to those that look about as much alike; configurations that
  /// nobody goes to start with their usual share. The rest knows nothing. Poses and weights stay.
  /// O( particles x columns + cells in common x pairs of configurations).
  void adopt(const PatchStates* before, std::uint64_t seed, std::uint64_t step,
             ParticleSet& particles) const;
  /// The rate of each sub-map [1/s].
  [[nodiscard]] double rate_per_s(std::size_t submap) const { return rates_[submap]; }
  /// After the motion: which sub-map each particle is in, and the change of configurations in dt_s.
  /// Same sub-map: kept, or drawn anew at its rate; a new one: drawn, from usual() [seed]. With
  /// memory the beliefs move towards usual() instead, and no configuration is drawn.
  void predict(double dt_s, std::uint64_t seed, std::uint64_t step, ParticleSet& particles,
               WorkerPool& pool) const;
  /// After the weights: shared beliefs learn, b_s(k) ~ b_s(k) sum_i w_i p(z | x_i, m_s = k), from
  /// the ratios that the sensor model left in the particles' rows; only while the pose is certain.
  void absorb(const Pose2Gaussian& pose, ParticleSet& particles) const;
  /// One entry a sub-map. Without memory P(k) is the weight of particles in s with k over that of
  /// all in s, usual() when none is in s.
  [[nodiscard]] std::vector<SubmapBelief> posterior(const ParticleSet& particles) const;
  /// The same into `beliefs`, whose memory is kept.
  void posterior(const ParticleSet& particles, std::vector<SubmapBelief>& beliefs) const;

 private:
  [[nodiscard]] std::int32_t draw_configuration(std::size_t submap, std::span<const float> usual,
                                                RandomStream& random) const;
  [[nodiscard]] std::int32_t next_configuration(std::size_t submap, std::int32_t now, double dt_s,
                                                std::span<const float> usual,
                                                RandomStream& random) const;
  void expect_something_else();
  void find_fading(double dt_s, std::span<const float> usual, std::vector<double>& keep,
                   std::vector<double>& add) const;
  std::shared_ptr<const patch::PatchMap> map_;
  PatchStatesConfig config_;
  std::vector<std::size_t> offsets_;
  std::vector<float> usual_;
  std::vector<std::size_t> followed_;              // sub-maps that follow the time
  std::vector<periodic::PeriodicShares> in_time_;  // of each of them
  ObjectPool<std::vector<double>> factors_;
  std::vector<double> rates_;  // gamma of each sub-map
  std::vector<float> something_else_;
  bool expects_something_else_ = false;
};

/// What a belief in the configurations of one sub-map leaves to something else.
[[nodiscard]] inline double left_of(std::span<const float> belief) {
  double sum = 0.0;
  for (const float b : belief) sum += static_cast<double>(b);
  return sum < 1.0 ? 1.0 - sum : 0.0;
}

/// The probability of a set of configurations. belief: of all of their sub-map.
[[nodiscard]] inline double probability_of(std::uint64_t mask, const float* belief) {
  double sum = 0.0;
  for (std::uint64_t left = mask; left != 0; left &= left - 1) {
    sum += static_cast<double>(belief[std::countr_zero(left)]);
  }
  return sum;
}

/// b(k) <- b(k) factor(k), normalized, never below `least`. Zero sums leave b as it is.
void update_belief(std::span<float> belief, std::span<const double> factor, double least);

}  // namespace strata::localization

template <>
struct strata::EnumNames<strata::localization::PatchMemory> {
  static constexpr std::array<std::pair<strata::localization::PatchMemory, const char*>, 3> values{
      {{strata::localization::PatchMemory::kNone, "none"},
       {strata::localization::PatchMemory::kShared, "shared"},
       {strata::localization::PatchMemory::kPerParticle, "per_particle"}}};
};

template <>
struct strata::EnumNames<strata::localization::RateSource> {
  static constexpr std::array<std::pair<strata::localization::RateSource, const char*>, 2> values{
      {{strata::localization::RateSource::kFixed, "fixed"},
       {strata::localization::RateSource::kLearned, "learned"}}};
};
