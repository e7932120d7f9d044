// SPDX-License-Identifier: Apache-2.0
#include "core/rays/beam_mixture.hpp"

#include <cmath>
#include <numbers>

#include "core/base/config.hpp"

namespace strata::rays {
namespace {

/// Mass of N(mean, s) inside [0, r_max].
double mass_inside(double mean_m, double stddev_m, double r_max_m) {
  const double scale = 1.0 / (stddev_m * std::numbers::sqrt2);
  return 0.5 * (std::erfc(-mean_m * scale) - std::erfc((r_max_m - mean_m) * scale));
}

}  // namespace

BeamMixture::BeamMixture(const BeamMixtureConfig& config, double r_max_m)
    : config_(config),
      r_max_m_(r_max_m),
      peak_(1.0 / (config.hit_stddev_m * std::sqrt(2.0 * std::numbers::pi))),
      half_inverse_(0.5 / (config.hit_stddev_m * config.hit_stddev_m)),
      short_scale_(short_scale_of(config, r_max_m)) {
  require_valid(config, "beam_mixture");
}

double BeamMixture::density(double range_m, double expected_m) const {
  const double rate = config_.short_rate_per_m;
  double p = config_.random_weight / r_max_m_;
  if (!(expected_m < r_max_m_)) {
    return p +
           config_.short_weight * rate * std::exp(-rate * range_m) / -std::expm1(-rate * r_max_m_);
  }
  const double off = range_m - expected_m;
  const double hit_weight =
      expected_m > 0.0 ? config_.hit_weight : config_.hit_weight + config_.short_weight;
  double hit = hit_weight * peak_ * std::exp(-off * off * half_inverse_);
  // Beyond 6 s of both ends the mass outside is below 1e-9.
  const double margin = 6.0 * config_.hit_stddev_m;
  if (expected_m < margin || expected_m > r_max_m_ - margin) {
    hit /= mass_inside(expected_m, config_.hit_stddev_m, r_max_m_);
  }
  p += hit;
  if (range_m < expected_m) {
    p += config_.short_weight * rate * std::exp(-rate * range_m) / -std::expm1(-rate * expected_m);
  }
  return p;
}

double BeamMixture::no_return(double expected_m) const {
  return expected_m < r_max_m_ ? config_.max_weight : config_.max_weight + config_.hit_weight;
}

double BeamMixture::likelihood_beyond(bool is_hit, double range_m, double free_m) const {
  if (!(free_m < r_max_m_)) return likelihood(is_hit, range_m, free_m);
  const double rate = config_.short_rate_per_m;
  if (is_hit && range_m < free_m) {
    return config_.random_weight / r_max_m_ + short_scale_ * rate * std::exp(-rate * range_m);
  }
  const double before =
      config_.random_weight * free_m / r_max_m_ + short_scale_ * -std::expm1(-rate * free_m);
  const double rest = 0.5 * (1.0 - before);
  return is_hit ? rest / (r_max_m_ - free_m) : rest;
}

bool BeamMixture::is_inlier(bool is_hit, double range_m, double expected_m) const {
  const bool expects_hit = expected_m < r_max_m_;
  if (!is_hit || !expects_hit) return is_hit == expects_hit;
  return std::abs(range_m - expected_m) <= tolerance_m();
}

}  // namespace strata::rays
