// SPDX-License-Identifier: Apache-2.0
// Highway compiles this file once for each SIMD target and picks one at run time.
#include "core/rays/scan_mixture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/rays/column_math.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/rays/scan_mixture.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace strata::rays::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
#include "core/base/lane_math.inc"
#include "core/rays/mixture_lanes.inc"

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

/// Whether any was left over.
bool log_bundle_lanes(const ScanMixture::Terms& terms, std::size_t beams, std::size_t bundles,
                      const double* expected_m, double* log_likelihood) {
  const Tag d;
  auto left = hn::Zero(d);
  for (std::size_t b = 0; b < beams; ++b) {
    const auto range = hn::Set(d, terms.range_m[b]);
    const auto short_m = hn::Set(d, terms.short_m[b]);
    const auto log_none = hn::Set(d, terms.log_none[b]);
    for (std::size_t at = b * bundles; at < (b + 1) * bundles; at += hn::Lanes(d)) {
      const auto logs = log_row(terms, hn::LoadU(d, expected_m + at), range, short_m, log_none);
      left = hn::Add(left, logs);  // NaN stays
      hn::StoreU(logs, d, log_likelihood + at);
    }
  }
  return !hn::AllFalse(d, hn::IsNaN(left));
}

/// Whether any was left over.
bool likelihood_row_lanes(const ScanMixture::Terms& terms, std::span<const SingleRow> rows,
                          const double* expected_m, double* likelihood) {
  const Tag d;
  auto left = hn::Zero(d);
  const double* expected = expected_m;
  double* out = likelihood;
  for (const SingleRow& row : rows) {
    const auto range = hn::Set(d, terms.range_m[row.beam]);
    const auto short_m = hn::Set(d, terms.short_m[row.beam]);
    for (std::size_t j = 0; j < BeamBundles::kVector; j += hn::Lanes(d)) {
      const auto e = hn::LoadU(d, expected + j);
      // Out of the way where nothing is expected: as the nearest.
      const auto some = hn::Min(e, hn::MinOfLanes(d, e));
      const auto filled = hn::IfThenElse(hn::Lt(e, hn::Set(d, terms.r_max_m)), e, some);
      const auto p = likelihood_row(terms, filled, range, short_m);
      left = hn::Add(left, p);  // NaN stays
      hn::StoreU(p, d, out + j);
    }
    expected += BeamBundles::kVector;
    out += BeamBundles::kVector;
  }
  return !hn::AllFalse(d, hn::IsNaN(left));
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

}  // namespace strata::rays::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace strata::rays {

HWY_EXPORT(log_lanes);
HWY_EXPORT(log_lanes_of);
HWY_EXPORT(log_bundle_lanes);
HWY_EXPORT(likelihood_row_lanes);

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
  terms_.missed = std::max(config.max_weight, 1e-300);
  terms_.log_missed = log_likelihood_of(config.max_weight);
  terms_.random = config.random_weight / mixture.r_max_m();
  terms_.log_random = terms_.random;
  log_column(&terms_.log_random, 1);
  terms_.hit_peak = config.hit_weight / (stddev * std::sqrt(2.0 * std::numbers::pi));
  terms_.half_inverse = 0.5 / (stddev * stddev);
  terms_.most_steep =
      terms_.random > 0.0 ? 34.0 + std::log1p(terms_.hit_peak / terms_.random) : 700.0;
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

void ScanMixture::log_likelihoods_of_bundles(std::size_t bundles, const double* expected_m,
                                             double* log_likelihood) const {
  Terms terms = terms_;
  terms.range_m = range_m_.data();
  terms.short_m = short_m_.data();
  terms.log_none = log_none_.data();
  if (!HWY_DYNAMIC_DISPATCH(log_bundle_lanes)(terms, size(), bundles, expected_m, log_likelihood)) {
    return;
  }
  for (std::size_t k = 0; k < size() * bundles; ++k) {
    if (!std::isnan(log_likelihood[k])) continue;
    const std::size_t b = k / bundles;
    log_likelihood[k] =
        log_likelihood_of(mixture_->likelihood(short_m_[b] >= 0.0, range_m_[b], expected_m[k]));
  }
}

void ScanMixture::likelihoods_of_rows(std::span<const SingleRow> rows, const double* expected_m,
                                      double* likelihood) const {
  Terms terms = terms_;
  terms.range_m = range_m_.data();
  terms.short_m = short_m_.data();
  if (!HWY_DYNAMIC_DISPATCH(likelihood_row_lanes)(terms, rows, expected_m, likelihood)) return;
  for (std::size_t k = 0; k < rows.size() * BeamBundles::kVector; ++k) {
    if (!std::isnan(likelihood[k])) continue;
    const std::size_t b = rows[k / BeamBundles::kVector].beam;
    likelihood[k] =
        std::max(1e-300, mixture_->likelihood(short_m_[b] >= 0.0, range_m_[b], expected_m[k]));
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

}  // namespace strata::rays
#endif  // HWY_ONCE
