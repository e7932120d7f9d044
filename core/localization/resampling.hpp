// SPDX-License-Identifier: Apache-2.0
/// Drawing particles by weight, and how many of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/localization/particle_set.hpp"

namespace strata::localization {

/// Low-variance resampling [thrun2005probabilistic, table 4.4]: indices[j] is the particle at
/// (offset + j) / count of the cumulated weight, so a particle of weight w is drawn floor or ceil
/// of count * w times and count * w on average. offset in [0, 1). Weights need not sum to 1. O(N +
/// count). Requires a positive sum.
void draw_low_variance(const std::vector<double>& weights, std::size_t count, double offset,
                       std::vector<std::uint32_t>& indices);

/// How many particles a posterior needs (docs/theory/patch_localization.md, "Resampling").
struct KldConfig {
  double epsilon = 0.05;
  double quantile = 2.326;
  double bin_m = 0.5;
  double bin_rad = 0.17453292519943295;
  int min_particles = 300;
  int max_particles = 20000;
  template <class Self, class V>
  static void describe(Self& c, V& v) {
    v.field(
        "epsilon", c.epsilon,
        {.doc = "bound on the divergence from the true posterior", .unit = "nats", .min = 1e-4});
    v.field("quantile", c.quantile,
            {.doc = "normal quantile of the confidence; 2.326 is 99%", .unit = "1", .min = 0.0});
    v.field("bin_m", c.bin_m, {.doc = "side of a bin", .unit = "m", .min = 0.01});
    v.field("bin_rad", c.bin_rad, {.doc = "heading of a bin", .unit = "rad", .min = 0.1});
    v.field("min_particles", c.min_particles,
            {.doc = "never fewer",
             .unit = "particles",
             .min = 1,
             .when = "the robot loses its way in places that look alike: raise it"});
    v.field("max_particles", c.max_particles,
            {.doc = "never more while tracking",
             .unit = "particles",
             .min = 1,
             .when = "the time of one update has to be bounded"});
    v.require(c.min_particles <= c.max_particles, "min_particles", "is above max_particles",
              "lower it");
  }
};

/// [fox2003adapting, eq. (12)]: (K-1)/(2 eps) (1 - 2/(9(K-1)) + sqrt(2/(9(K-1))) z)^3, rounded up;
/// 1 for K <= 1.
[[nodiscard]] std::size_t kld_particle_count(std::size_t bins, double epsilon, double quantile);

/// How many bins of (x, y, heading, sub-map, patch) the drawn particles fill. O(count).
[[nodiscard]] std::size_t count_bins(const ParticleSet& particles,
                                     const std::vector<std::uint32_t>& indices,
                                     const KldConfig& config, std::vector<std::uint64_t>& scratch);

}  // namespace strata::localization
