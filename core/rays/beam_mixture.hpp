// SPDX-License-Identifier: Apache-2.0
/// What a beam measures when the map says how far it should go: one mixture for all map models, so
/// that only the expected range differs (docs/theory/patch_localization.md, "Beam model").
#pragma once

#include <algorithm>
#include <cmath>

namespace strata::rays {

/// Weights sum to 1; they are ours (docs/theory/patch_localization.md, "Beam model").
struct BeamMixtureConfig {
  double hit_weight = 0.80;
  double short_weight = 0.10;
  double max_weight = 0.02;
  double random_weight = 0.08;
  double hit_stddev_m = 0.15;
  double short_rate_per_m = 1.0;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field("hit_weight", c.hit_weight,
            {.doc = "share of beams that measure the expected obstacle",
             .unit = "1",
             .min = 0.0,
             .max = 1.0});
    v.field("short_weight", c.short_weight,
            {.doc = "share of beams stopped before it", .unit = "1", .min = 0.0, .max = 1.0});
    v.field("max_weight", c.max_weight,
            {.doc = "share of beams that return nothing", .unit = "1", .min = 0.0, .max = 1.0});
    v.field("random_weight", c.random_weight,
            {.doc = "share of beams that measure anything", .unit = "1", .min = 0.0, .max = 1.0});
    v.field("hit_stddev_m", c.hit_stddev_m,
            {.doc = "spread about the expected range, errors of map and pose included",
             .unit = "m",
             .min = 1e-3,
             .when = "the scanner is noisier, or the map less exact, than a few centimetres"});
    v.field("short_rate_per_m", c.short_rate_per_m,
            {.doc = "rate of the exponential of stopped beams", .unit = "1/m", .min = 1e-6});
    const double sum = c.hit_weight + c.short_weight + c.max_weight + c.random_weight;
    v.require(sum > 1.0 - 1e-9 && sum < 1.0 + 1e-9, "hit_weight",
              "and the other weights do not sum to 1", "make the four weights sum to 1");
  }
};

/// ln of a likelihood, no less than ln 1e-300: weights may be 0, and two impossible places of a
/// beam must not cancel to NaN.
[[nodiscard]] inline double log_likelihood_of(double likelihood) {
  return std::log(std::max(likelihood, 1e-300));
}

/// p(z | z*) on [0, r_max] after [thrun2005probabilistic, section 6.3.1], with every term
/// normalized there: a density on [0, r_max) in 1/m, and a probability for "nothing returned".
///
///   p(z|z*)    = w_hit N(z; z*, s) / mass in [0, r_max] + w_short [z < z*] l e^{-lz}/(1 - e^{-l
///   z*})
///              + w_rand / r_max
///   p(max|z*)  = w_max
///
/// Where nothing is expected within r_max (z* >= r_max), the hit term is the atom itself:
/// p(max) = w_hit + w_max. The paper's form, a Gaussian about r_max there, would give "nothing
/// returned" a density instead of a probability. Where the obstacle is at the sensor (z* = 0), no
/// beam can be shorter and the hit term takes the short one's weight.
class BeamMixture {
 public:
  /// Throws ConfigError for invalid constants. Requires r_max_m > 0.
  BeamMixture(const BeamMixtureConfig& config, double r_max_m);

  /// The same with another limit; cheap, for every scan has its own.
  [[nodiscard]] BeamMixture limited_to(double r_max_m) const {
    BeamMixture result = *this;
    result.r_max_m_ = r_max_m;
    result.short_scale_ = short_scale_of(config_, r_max_m);
    return result;
  }
  [[nodiscard]] const BeamMixtureConfig& config() const { return config_; }
  [[nodiscard]] double r_max_m() const { return r_max_m_; }
  /// Density at z in [0, r_max) [1/m]; any expected range, +infinity for none.
  [[nodiscard]] double density(double range_m, double expected_m) const;
  /// Probability that nothing returns.
  [[nodiscard]] double no_return(double expected_m) const;
  /// ... when the map knows only that the way is free to free_m, and not what comes then: up to
  /// there as where nothing is expected; the rest of the mass is half for a hit anywhere behind,
  /// half for no return.
  [[nodiscard]] double likelihood_beyond(bool is_hit, double range_m, double free_m) const;
  /// Either of the two, as the beam was: is_hit says whether range_m counts.
  [[nodiscard]] double likelihood(bool is_hit, double range_m, double expected_m) const {
    return is_hit ? density(range_m, expected_m) : no_return(expected_m);
  }
  /// How far from what is expected a beam may end and still be an inlier: 3 s.
  [[nodiscard]] double tolerance_m() const { return 3.0 * config_.hit_stddev_m; }
  /// How far from any surface of the map a beam may end and still be at it: 2 s, less than along
  /// the beam, since surfaces lie on all sides.
  [[nodiscard]] double surface_tolerance_m() const { return 2.0 * config_.hit_stddev_m; }
  /// Whether the beam is an inlier of an expected range: within that of it, or nothing where
  /// nothing is.
  [[nodiscard]] bool is_inlier(bool is_hit, double range_m, double expected_m) const;

 private:
  [[nodiscard]] static double short_scale_of(const BeamMixtureConfig& config, double r_max_m) {
    return config.short_weight / -std::expm1(-config.short_rate_per_m * r_max_m);
  }

  BeamMixtureConfig config_;
  double r_max_m_;
  double peak_;          ///< 1 / (s sqrt(2 pi))
  double half_inverse_;  ///< 1 / (2 s^2)
  double short_scale_;   ///< so that the short readings of a free beam have their weight
};

}  // namespace strata::rays
