// SPDX-License-Identifier: Apache-2.0
// Highway compiles this file once for each SIMD target and picks one at run time.
#include "core/localization/scan_mixture.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/localization/scan_mixture.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace strata::localization::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
#include "core/localization/lane_math.inc"

/// NaN for beams that are left to BeamMixture.
HWY_INLINE Lanes log_row(const ScanMixture::Terms& terms, Lanes expected, Lanes range, Lanes is_hit,
                         Lanes short_m, Lanes log_none) {
  const Tag d;
  const auto zero = hn::Zero(d);
  const auto r_max = hn::Set(d, terms.r_max_m);
  const auto expects = hn::Lt(expected, r_max);
  const auto hits = hn::Gt(is_hit, zero);
  const auto is_whole = hn::And(hn::Ge(expected, hn::Set(d, terms.margin_m)),
                                hn::Le(expected, hn::Set(d, terms.r_max_m - terms.margin_m)));
  // Out of the way of infinity where nothing is expected.
  const auto e = hn::IfThenElse(expects, expected, r_max);
  const auto off = hn::Sub(range, e);
  const auto gauss = exp_of(d, hn::Mul(hn::Mul(off, off), hn::Set(d, -terms.half_inverse)));
  const auto in_front =
      hn::Sub(hn::Set(d, 1.0), exp_of(d, hn::Mul(e, hn::Set(d, -terms.rate_per_m))));
  auto p = hn::Add(hn::Set(d, terms.random), hn::Mul(hn::Set(d, terms.hit_peak), gauss));
  p = hn::Add(p, hn::IfThenElseZero(hn::Lt(range, e), hn::Div(short_m, in_front)));
  const auto is_plain = hn::And(is_whole, hn::Gt(p, hn::Set(d, 1e-300)));
  const auto left = hn::Set(d, std::numeric_limits<double>::quiet_NaN());
  const auto hit_value = hn::IfThenElse(is_plain, log_of(d, hn::Max(p, hn::Set(d, 1e-300))), left);
  const auto met = hn::IfThenElse(hits, hit_value, hn::Set(d, terms.log_missed));
  return hn::IfThenElse(expects, met, log_none);
}

void log_lanes(const ScanMixture::Terms& terms, std::size_t count, const double* expected_m,
               double* log_likelihood) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  const auto row = [&](const double* expected, const double* range, const double* is_hit,
                       const double* short_m, const double* log_none, double* out) {
    hn::StoreU(log_row(terms, hn::LoadU(d, expected), hn::LoadU(d, range), hn::LoadU(d, is_hit),
                       hn::LoadU(d, short_m), hn::LoadU(d, log_none)),
               d, out);
  };
  std::size_t k = 0;
  for (; k + lanes <= count; k += lanes) {
    row(expected_m + k, terms.range_m + k, terms.is_hit + k, terms.short_m + k, terms.log_none + k,
        log_likelihood + k);
  }
  if (k == count) return;
  double rest[5][kParts] = {};
  std::copy(expected_m + k, expected_m + count, rest[0]);
  std::copy(terms.range_m + k, terms.range_m + count, rest[1]);
  std::copy(terms.is_hit + k, terms.is_hit + count, rest[2]);
  std::copy(terms.short_m + k, terms.short_m + count, rest[3]);
  std::copy(terms.log_none + k, terms.log_none + count, rest[4]);
  double out[kParts];
  row(rest[0], rest[1], rest[2], rest[3], rest[4], out);
  std::copy(out, out + (count - k), log_likelihood + k);
}

}  // namespace strata::localization::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace strata::localization {

HWY_EXPORT(log_lanes);

void ScanMixture::prepare(const BeamMixture& mixture, const ScanBeams& beams) {
  constexpr double kNothing = std::numeric_limits<double>::infinity();
  mixture_ = mixture;
  const BeamMixtureConfig& config = mixture.config();
  const double stddev = config.hit_stddev_m;
  terms_.log_missed = std::log(config.max_weight);
  terms_.random = config.random_weight / mixture.r_max_m();
  terms_.hit_peak = config.hit_weight / (stddev * std::sqrt(2.0 * std::numbers::pi));
  terms_.half_inverse = 0.5 / (stddev * stddev);
  terms_.rate_per_m = config.short_rate_per_m;
  terms_.r_max_m = mixture.r_max_m();
  terms_.margin_m = 6.0 * stddev;
  range_m_.resize(beams.size());
  is_hit_.resize(beams.size());
  short_m_.resize(beams.size());
  log_none_.resize(beams.size());
  for (std::size_t k = 0; k < beams.size(); ++k) {
    const bool is_hit = beams.is_hit[k] != 0;
    range_m_[k] = beams.range_m[k];
    is_hit_[k] = is_hit ? 1.0 : 0.0;
    short_m_[k] = config.short_weight * config.short_rate_per_m *
                  std::exp(-config.short_rate_per_m * beams.range_m[k]);
    log_none_[k] = std::log(mixture.likelihood(is_hit, beams.range_m[k], kNothing));
  }
}

void ScanMixture::log_likelihoods(std::size_t begin, std::size_t count, const double* expected_m,
                                  double* log_likelihood) const {
  Terms terms = terms_;
  terms.range_m = range_m_.data() + begin;
  terms.is_hit = is_hit_.data() + begin;
  terms.short_m = short_m_.data() + begin;
  terms.log_none = log_none_.data() + begin;
  HWY_DYNAMIC_DISPATCH(log_lanes)(terms, count, expected_m, log_likelihood);
  for (std::size_t k = 0; k < count; ++k) {
    if (!std::isnan(log_likelihood[k])) continue;
    log_likelihood[k] = std::log(
        mixture_->likelihood(is_hit_[begin + k] > 0.0, range_m_[begin + k], expected_m[k]));
  }
}

}  // namespace strata::localization
#endif  // HWY_ONCE
