// SPDX-License-Identifier: Apache-2.0
// Highway compiles this file once for each SIMD target and picks one at run time.
#include "core/localization/scan_mixture.hpp"

#include <algorithm>
#include <array>
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
#include "core/base/lane_math.inc"

/// Mass of a standard normal below u, 0 <= u <= 6: cubic between the entries of the table.
HWY_INLINE Lanes mass_below(const ScanMixture::Terms& terms, Lanes u) {
  const Tag d;
  const hn::Rebind<std::int32_t, Tag> di;
  const hn::RebindToSigned<Tag> dl;
  const auto scaled =
      hn::Min(hn::Mul(u, hn::Set(d, ScanMixture::Terms::kSteps)),
              hn::Set(d, ScanMixture::Terms::kEntries - 1.5));  // the last interval at most
  const auto low = hn::Floor(scaled);
  const auto f = hn::Sub(scaled, low);
  const auto k = hn::PromoteTo(dl, hn::DemoteTo(di, low));
  const auto m0 = hn::GatherIndex(d, terms.mass, k);
  const auto m1 = hn::GatherIndex(d, terms.mass + 1, k);
  const auto s0 = hn::GatherIndex(d, terms.slope, k);
  const auto s1 = hn::GatherIndex(d, terms.slope + 1, k);
  const auto rise = hn::Sub(m1, m0);
  // Hermite: m0 + f (s0 + f (3 rise - 2 s0 - s1 + f (s0 + s1 - 2 rise))).
  const auto cubic = hn::Sub(hn::Add(s0, s1), hn::Add(rise, rise));
  const auto square = hn::Sub(hn::Sub(rise, s0), cubic);
  return hn::Add(m0, hn::Mul(f, hn::Add(s0, hn::Mul(f, hn::Add(square, hn::Mul(f, cubic))))));
}

/// NaN for beams that are left to BeamMixture.
HWY_INLINE Lanes log_row(const ScanMixture::Terms& terms, Lanes expected, Lanes range,
                         Lanes short_m, Lanes log_none) {
  const Tag d;
  const auto zero = hn::Zero(d);
  const auto r_max = hn::Set(d, terms.r_max_m);
  const auto margin = hn::Set(d, terms.margin_m);
  const auto expects = hn::Lt(expected, r_max);
  const auto hits = hn::Ge(short_m, zero);
  // Out of the way of infinity where nothing is expected.
  const auto e = hn::IfThenElse(expects, expected, r_max);
  const auto off = hn::Sub(range, e);
  auto gauss = exp_of(d, hn::Mul(hn::Mul(off, off), hn::Set(d, -terms.half_inverse)));
  const auto is_near = hn::Lt(e, margin);
  if (!hn::AllFalse(d, is_near)) {
    const auto u = hn::Min(hn::Max(e, zero), margin);
    const auto mass = mass_below(terms, hn::Mul(u, hn::Set(d, terms.per_stddev)));
    gauss = hn::IfThenElse(is_near, hn::Div(gauss, mass), gauss);
  }
  const auto in_front =
      hn::Sub(hn::Set(d, 1.0), exp_of(d, hn::Mul(e, hn::Set(d, -terms.rate_per_m))));
  auto p = hn::Add(hn::Set(d, terms.random), hn::Mul(hn::Set(d, terms.hit_peak), gauss));
  p = hn::Add(p, hn::IfThenElseZero(hn::Lt(range, e), hn::Div(short_m, in_front)));
  // Left over: obstacles close to the far end or at the sensor, and likelihoods of nearly 0.
  auto is_plain =
      hn::And(hn::Gt(e, hn::Set(d, terms.nearest_m)), hn::Le(e, hn::Sub(r_max, margin)));
  is_plain = hn::And(is_plain, hn::Gt(p, hn::Set(d, 1e-300)));
  const auto left = hn::Set(d, std::numeric_limits<double>::quiet_NaN());
  const auto hit_value = hn::IfThenElse(is_plain, log_of(d, hn::Max(p, hn::Set(d, 1e-300))), left);
  const auto met = hn::IfThenElse(hits, hit_value, hn::Set(d, terms.log_missed));
  return hn::IfThenElse(expects, met, log_none);
}

void log_lanes(const ScanMixture::Terms& terms, std::size_t count, const double* expected_m,
               double* log_likelihood) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  const auto row = [&](const double* expected, const double* range, const double* short_m,
                       const double* log_none, double* out) {
    hn::StoreU(log_row(terms, hn::LoadU(d, expected), hn::LoadU(d, range), hn::LoadU(d, short_m),
                       hn::LoadU(d, log_none)),
               d, out);
  };
  std::size_t k = 0;
  for (; k + lanes <= count; k += lanes) {
    row(expected_m + k, terms.range_m + k, terms.short_m + k, terms.log_none + k,
        log_likelihood + k);
  }
  if (k == count) return;
  double rest[4][kParts] = {};
  std::copy(expected_m + k, expected_m + count, rest[0]);
  std::copy(terms.range_m + k, terms.range_m + count, rest[1]);
  std::copy(terms.short_m + k, terms.short_m + count, rest[2]);
  std::copy(terms.log_none + k, terms.log_none + count, rest[3]);
  double out[kParts];
  row(rest[0], rest[1], rest[2], rest[3], out);
  std::copy(out, out + (count - k), log_likelihood + k);
}

void log_lanes_of(const ScanMixture::Terms& terms, const double* beam, std::size_t count,
                  const double* expected_m, double* log_likelihood) {
  const Tag d;
  const hn::Rebind<std::int32_t, Tag> di;
  const hn::RebindToSigned<Tag> dl;
  const std::size_t lanes = hn::Lanes(d);
  // Where nothing is expected, left to BeamMixture: that is rare here.
  const auto log_none = hn::Set(d, std::numeric_limits<double>::quiet_NaN());
  const auto row = [&](const double* beams, const double* expected, double* out) {
    const auto k = hn::PromoteTo(dl, hn::DemoteTo(di, hn::LoadU(d, beams)));
    hn::StoreU(log_row(terms, hn::LoadU(d, expected), hn::GatherIndex(d, terms.range_m, k),
                       hn::GatherIndex(d, terms.short_m, k), log_none),
               d, out);
  };
  std::size_t k = 0;
  for (; k + lanes <= count; k += lanes) row(beam + k, expected_m + k, log_likelihood + k);
  if (k == count) return;
  double rest[2][kParts] = {};
  std::copy(beam + k, beam + count, rest[0]);
  std::copy(expected_m + k, expected_m + count, rest[1]);
  double out[kParts];
  row(rest[0], rest[1], out);
  std::copy(out, out + (count - k), log_likelihood + k);
}

void mix_lanes(const double* share, const double* first, const double* second, std::size_t count,
               double* mixed) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  const auto row = [&](const double* p, const double* a_log, const double* b_log, double* out) {
    const auto p_first = hn::LoadU(d, p);
    const auto a = hn::LoadU(d, a_log);
    const auto b = hn::LoadU(d, b_log);
    const auto top = hn::Max(a, b);
    const auto p_second = hn::Sub(hn::Set(d, 1.0), p_first);
    const auto is_first = hn::Ge(a, b);
    const auto below = exp_of(d, hn::Sub(hn::Min(a, b), top));
    const auto sum = hn::Add(hn::IfThenElse(is_first, p_first, p_second),
                             hn::Mul(hn::IfThenElse(is_first, p_second, p_first), below));
    hn::StoreU(hn::Add(top, log_of(d, hn::Max(sum, hn::Set(d, 1e-300)))), d, out);
  };
  std::size_t k = 0;
  for (; k + lanes <= count; k += lanes) row(share + k, first + k, second + k, mixed + k);
  if (k == count) return;
  double rest[3][kParts] = {};
  std::copy(share + k, share + count, rest[0]);
  std::copy(first + k, first + count, rest[1]);
  std::copy(second + k, second + count, rest[2]);
  double out[kParts];
  row(rest[0], rest[1], rest[2], out);
  std::copy(out, out + (count - k), mixed + k);
}

/// One vector of columns.
template <class D>
HWY_INLINE void mix_columns(D d, std::span<const double> weight, const double* logs,
                            std::size_t stride, double* mixed) {
  auto sum = hn::Zero(d);
  for (std::size_t r = 0; r < weight.size(); ++r) {
    const auto p = exp_of(d, hn::LoadU(d, logs + r * stride));
    sum = hn::Add(sum, hn::Mul(hn::Set(d, weight[r]), p));
  }
  hn::StoreU(log_of(d, hn::Max(sum, hn::Set(d, 1e-300))), d, mixed);
}

void mix_row_lanes(std::span<const double> weight, const double* logs, std::size_t stride,
                   std::size_t count, double* mixed) {
  const std::size_t lanes = hn::Lanes(Tag());
  std::size_t k = 0;
  for (; k + lanes <= count; k += lanes) mix_columns(Tag(), weight, logs + k, stride, mixed + k);
  const hn::CappedTag<double, 1> one;
  for (; k < count; ++k) mix_columns(one, weight, logs + k, stride, mixed + k);
}

}  // namespace strata::localization::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace strata::localization {

HWY_EXPORT(log_lanes);
HWY_EXPORT(log_lanes_of);
HWY_EXPORT(mix_lanes);
HWY_EXPORT(mix_row_lanes);

namespace {
/// The cumulated standard normal from 0 to 6 and its density, both a step of the table.
struct MassTable {
  static constexpr int kSteps = ScanMixture::Terms::kSteps;
  static constexpr int kEntries = ScanMixture::Terms::kEntries;
  std::array<double, kEntries> mass{};
  std::array<double, kEntries> slope{};
  MassTable() {
    for (int i = 0; i < kEntries; ++i) {
      const double u = static_cast<double>(i) / kSteps;
      const auto place = static_cast<std::size_t>(i);
      mass[place] = 0.5 * std::erfc(-u / std::numbers::sqrt2);
      slope[place] = std::exp(-0.5 * u * u) / std::sqrt(2.0 * std::numbers::pi) / kSteps;
    }
  }
};
const MassTable& mass_table() {
  static const MassTable table;
  return table;
}
}  // namespace

void ScanMixture::prepare(const BeamMixture& mixture, const ScanBeams& beams) {
  constexpr double kNothing = std::numeric_limits<double>::infinity();
  mixture_ = mixture;
  const BeamMixtureConfig& config = mixture.config();
  const double stddev = config.hit_stddev_m;
  terms_.log_missed = log_likelihood_of(config.max_weight);
  terms_.random = config.random_weight / mixture.r_max_m();
  terms_.hit_peak = config.hit_weight / (stddev * std::sqrt(2.0 * std::numbers::pi));
  terms_.half_inverse = 0.5 / (stddev * stddev);
  terms_.rate_per_m = config.short_rate_per_m;
  terms_.r_max_m = mixture.r_max_m();
  terms_.margin_m = 6.0 * stddev;
  // 1 - e^(-l z) loses digits where l z is tiny.
  terms_.nearest_m = 1e-6 / config.short_rate_per_m;
  terms_.per_stddev = 1.0 / stddev;
  terms_.mass = mass_table().mass.data();
  terms_.slope = mass_table().slope.data();
  range_m_.resize(beams.size());
  short_m_.resize(beams.size());
  log_none_.resize(beams.size());
  for (std::size_t k = 0; k < beams.size(); ++k) {
    const bool is_hit = beams.is_hit[k] != 0;
    range_m_[k] = beams.range_m[k];
    short_m_[k] = is_hit ? config.short_weight * config.short_rate_per_m *
                               std::exp(-config.short_rate_per_m * beams.range_m[k])
                         : -1.0;
    log_none_[k] = log_likelihood_of(mixture.likelihood(is_hit, beams.range_m[k], kNothing));
  }
}

void ScanMixture::log_likelihoods(std::size_t begin, std::size_t count, const double* expected_m,
                                  double* log_likelihood) const {
  Terms terms = terms_;
  terms.range_m = range_m_.data() + begin;
  terms.short_m = short_m_.data() + begin;
  terms.log_none = log_none_.data() + begin;
  HWY_DYNAMIC_DISPATCH(log_lanes)(terms, count, expected_m, log_likelihood);
  for (std::size_t k = 0; k < count; ++k) {
    if (!std::isnan(log_likelihood[k])) continue;
    log_likelihood[k] = log_likelihood_of(
        mixture_->likelihood(short_m_[begin + k] >= 0.0, range_m_[begin + k], expected_m[k]));
  }
}

void ScanMixture::log_likelihoods_of(const double* beam, std::size_t count,
                                     const double* expected_m, double* log_likelihood) const {
  Terms terms = terms_;
  terms.range_m = range_m_.data();
  terms.short_m = short_m_.data();
  HWY_DYNAMIC_DISPATCH(log_lanes_of)(terms, beam, count, expected_m, log_likelihood);
  for (std::size_t k = 0; k < count; ++k) {
    if (!std::isnan(log_likelihood[k])) continue;
    const auto b = static_cast<std::size_t>(beam[k]);
    log_likelihood[k] =
        log_likelihood_of(mixture_->likelihood(short_m_[b] >= 0.0, range_m_[b], expected_m[k]));
  }
}

void mix_logs(const double* share, const double* first, const double* second, std::size_t count,
              double* mixed) {
  HWY_DYNAMIC_DISPATCH(mix_lanes)(share, first, second, count, mixed);
}

void mix_rows(std::span<const double> weight, const double* logs, std::size_t stride,
              std::size_t count, double* mixed) {
  HWY_DYNAMIC_DISPATCH(mix_row_lanes)(weight, logs, stride, count, mixed);
}

}  // namespace strata::localization
#endif  // HWY_ONCE
