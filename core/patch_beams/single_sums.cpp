// SPDX-License-Identifier: Apache-2.0
// Highway compiles this file once for each SIMD target and picks one at run time.
#include "core/patch_beams/single_sums.hpp"

#include <algorithm>
#include <limits>
#include <numbers>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/patch_beams/single_sums.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace strata::patch_beams::HWY_NAMESPACE {
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

/// met_m, near: of one row; share, logs and sums: of its first bundle.
template <bool kWithBoth>
HWY_INLINE void mix_row_of_beam(const double* met_m, const double* near, const double* share,
                                double* logs, const SingleSums::Columns& sums) {
  const Tag d;
  const auto one = hn::Set(d, 1.0);
  for (std::size_t j = 0; j < rays::BeamBundles::kVector; j += hn::Lanes(d)) {
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
HWY_INLINE void mix_rows_of_beams(std::span<const rays::SingleRow> rows, const double* met_m,
                                  const double* near, std::size_t bundles, const double* share,
                                  double* logs, const SingleSums::Columns& sums) {
  for (std::size_t n = 0; n < rows.size(); ++n) {
    const std::size_t place = rows[n].box * bundles + rows[n].bundle;
    mix_row_of_beam<kWithBoth>(
        met_m + n * rays::BeamBundles::kVector, near + n * rays::BeamBundles::kVector,
        share + place, logs + rows[n].beam * bundles + rows[n].bundle,
        {sums.near + place, sums.far + place, sums.mixed + place, sums.beams + place,
         sums.near_power + place, sums.mixed_power + place});
  }
}

/// Products become logarithms.
template <bool kWithBoth>
HWY_INLINE void end_sums(std::span<const double> share, const SingleSums::Columns& sums) {
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

void mix_single_lanes(std::span<const rays::SingleRow> rows, const double* met_m,
                      const double* near, std::size_t bundles, std::span<const double> share,
                      bool with_both, double* logs, const SingleSums::Columns& sums) {
  if (with_both) {
    mix_rows_of_beams<true>(rows, met_m, near, bundles, share.data(), logs, sums);
    end_sums<true>(share, sums);
  } else {
    mix_rows_of_beams<false>(rows, met_m, near, bundles, share.data(), logs, sums);
    end_sums<false>(share, sums);
  }
}

}  // namespace strata::patch_beams::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace strata::patch_beams {

HWY_EXPORT(mix_single_lanes);

SingleSums::Columns SingleSums::take(const SingleBeams& beams, const rays::ScanMixture& mixture,
                                     std::size_t bundles, std::span<const double> share,
                                     bool with_both, double* logs) {
  columns_.assign(Columns::kCount * share.size(), 0.0);
  const auto column = [&](std::size_t n) { return columns_.data() + n * share.size(); };
  const Columns sums{column(0), column(1), column(2), column(3), column(4), column(5)};
  std::fill_n(sums.near, share.size(), 1.0);
  std::fill_n(sums.mixed, share.size(), 1.0);
  const std::span<const rays::SingleRow> rows = beams.all_rows();
  const std::size_t places = rows.size() * rays::BeamBundles::kVector;
  if (near_.size() < places) near_.resize(2 * places);
  mixture.likelihoods_of_rows(rows, beams.range_m(0), near_.data());
  HWY_DYNAMIC_DISPATCH(mix_single_lanes)
  (rows, beams.range_m(0), near_.data(), bundles, share, with_both, logs, sums);
  return sums;
}

}  // namespace strata::patch_beams
#endif  // HWY_ONCE
