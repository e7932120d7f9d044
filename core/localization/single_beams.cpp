// SPDX-License-Identifier: Apache-2.0
// Highway compiles this file once for each SIMD target and picks one at run time.
#include "core/localization/single_beams.hpp"

#include <algorithm>
#include <limits>
#include <numbers>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/localization/single_beams.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace strata::localization::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
#include "core/base/lane_math.inc"

/// A product of many factors in [1e-300, 2^1000): product in [1, 2) times 2^power. The same bits in
/// whatever vectors.
HWY_INLINE void multiply(double* product, double* power, Lanes factor) {
  const Tag d;
  const Words du;
  const auto bits = hn::BitCast(du, hn::Mul(hn::LoadU(d, product), factor));
  // Whole numbers below 2^52 in the mantissa of 2^52.
  const auto exponent = hn::Or(hn::ShiftRight<52>(bits), hn::Set(du, 0x4330000000000000ULL));
  const auto more = hn::Sub(hn::BitCast(d, exponent), hn::Set(d, 0x1p52 + 1023.0));
  hn::StoreU(hn::Add(hn::LoadU(d, power), more), d, power);
  const auto mantissa = hn::And(bits, hn::Set(du, 0x000FFFFFFFFFFFFFULL));
  hn::StoreU(hn::BitCast(d, hn::Or(mantissa, hn::Set(du, 0x3FF0000000000000ULL))), d, product);
}

HWY_INLINE Lanes log_of_product(const double* product, const double* power) {
  const Tag d;
  return hn::Add(hn::Mul(hn::LoadU(d, power), hn::Set(d, std::numbers::ln2)),
                 log_of(d, hn::LoadU(d, product)));
}

/// column += value in the lanes that count.
HWY_INLINE void add_to(double* column, hn::Mask<Tag> counts, Lanes value) {
  const Tag d;
  hn::StoreU(hn::Add(hn::LoadU(d, column), hn::IfThenElseZero(counts, value)), d, column);
}

/// met_m, near: of one row; share, logs and sums: of its first fan.
template <bool kWithBoth>
HWY_INLINE void mix_row_of_beam(const double* met_m, const double* near, const double* share,
                                double* logs, const SingleBeams::Sums& sums) {
  const Tag d;
  const auto one = hn::Set(d, 1.0);
  for (std::size_t j = 0; j < RayFans::kVector; j += hn::Lanes(d)) {
    const auto is_met =
        hn::Lt(hn::LoadU(d, met_m + j), hn::Set(d, std::numeric_limits<double>::infinity()));
    if (hn::AllFalse(d, is_met)) continue;
    const auto p_near = hn::LoadU(d, near + j);
    const auto far = hn::LoadU(d, logs + j);
    const auto there = hn::LoadU(d, share + j);
    const auto is_mixed = hn::And(is_met, hn::Ge(there, hn::Zero(d)));
    if (!hn::AllFalse(d, is_mixed)) {
      auto p = p_near;
      if (!hn::AllFalse(d, hn::And(is_mixed, hn::Lt(there, one)))) {
        const auto behind = hn::Mul(hn::Sub(one, there), exp_of(d, far));
        p = hn::Max(hn::Add(hn::Mul(there, p_near), behind), hn::Set(d, 1e-300));
      }
      multiply(sums.mixed + j, sums.mixed_power + j, hn::IfThenElse(is_mixed, p, one));
    }
    if constexpr (kWithBoth) {
      multiply(sums.near + j, sums.near_power + j, hn::IfThenElse(is_met, p_near, one));
      add_to(sums.far + j, is_met, far);
    }
    add_to(sums.beams + j, is_met, one);
    hn::StoreU(hn::IfThenZeroElse(is_met, far), d, logs + j);
  }
}

template <bool kWithBoth>
HWY_INLINE void mix_rows_of_beams(std::span<const SingleRow> rows, const double* met_m,
                                  const double* near, std::size_t fans, const double* share,
                                  double* logs, const SingleBeams::Sums& sums) {
  for (std::size_t n = 0; n < rows.size(); ++n) {
    const std::size_t place = rows[n].box * fans + rows[n].fan;
    mix_row_of_beam<kWithBoth>(
        met_m + n * RayFans::kVector, near + n * RayFans::kVector, share + place,
        logs + rows[n].beam * fans + rows[n].fan,
        {sums.near + place, sums.far + place, sums.mixed + place, sums.beams + place,
         sums.near_power + place, sums.mixed_power + place});
  }
}

/// Products become logarithms.
template <bool kWithBoth>
HWY_INLINE void end_sums(std::span<const double> share, const SingleBeams::Sums& sums) {
  const Tag d;
  for (std::size_t k = 0; k < share.size(); k += hn::Lanes(d)) {
    if (hn::AllFalse(d, hn::Gt(hn::LoadU(d, sums.beams + k), hn::Zero(d)))) continue;
    auto mixed = log_of_product(sums.mixed + k, sums.mixed_power + k);
    if constexpr (kWithBoth) {
      const auto near = log_of_product(sums.near + k, sums.near_power + k);
      const auto far = hn::LoadU(d, sums.far + k);
      mixed = hn::IfThenElse(hn::Ge(hn::LoadU(d, share.data() + k), hn::Zero(d)), mixed, far);
      hn::StoreU(hn::Sub(near, mixed), d, sums.near + k);
      hn::StoreU(hn::Sub(far, mixed), d, sums.far + k);
    }
    hn::StoreU(mixed, d, sums.mixed + k);
  }
}

void mix_single_lanes(std::span<const SingleRow> rows, const double* met_m, const double* near,
                      std::size_t fans, std::span<const double> share, bool with_both, double* logs,
                      const SingleBeams::Sums& sums) {
  if (with_both) {
    mix_rows_of_beams<true>(rows, met_m, near, fans, share.data(), logs, sums);
    end_sums<true>(share, sums);
  } else {
    mix_rows_of_beams<false>(rows, met_m, near, fans, share.data(), logs, sums);
    end_sums<false>(share, sums);
  }
}

}  // namespace strata::localization::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace strata::localization {

HWY_EXPORT(mix_single_lanes);

SingleRows& SingleBeams::rows(std::size_t more) {
  const std::size_t count = rows_.count + more;
  if (row_.size() < count) {
    row_.resize(2 * count);
    for (auto* column : {&from_m_, &to_m_, &hidden_, &range_m_, &near_}) {
      column->resize(2 * count * RayFans::kVector);
    }
  }
  rows_.rows = row_.data();
  rows_.from_m = from_m_.data();
  rows_.to_m = to_m_.data();
  rows_.hidden = hidden_.data();
  return rows_;
}

void SingleBeams::cast(const RayTable& table, const RayFans& fans) {
  cast_rows(table, fans, rows_, range_m_.data());
}

void SingleBeams::mix(const ScanMixture& mixture, std::size_t fans, std::span<const double> share,
                      bool with_both, double* logs) {
  sum_columns_.assign(Sums::kColumns * share.size(), 0.0);
  double* const columns = sum_columns_.data();
  const auto column = [&](std::size_t n) { return columns + n * share.size(); };
  sums_ = {column(0), column(1), column(2), column(3), column(4), column(5)};
  std::fill_n(sums_.near, share.size(), 1.0);
  std::fill_n(sums_.mixed, share.size(), 1.0);
  const std::span<const SingleRow> rows(row_.data(), rows_.count);
  mixture.likelihoods_of_rows(rows, range_m_.data(), near_.data());
  HWY_DYNAMIC_DISPATCH(mix_single_lanes)
  (rows, range_m_.data(), near_.data(), fans, share, with_both, logs, sums_);
}

}  // namespace strata::localization
#endif  // HWY_ONCE
