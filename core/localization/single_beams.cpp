// SPDX-License-Identifier: Apache-2.0
// Highway compiles this file once for each SIMD target and picks one at run time.
#include "core/localization/single_beams.hpp"

#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/localization/single_beams.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace strata::localization::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
#include "core/base/lane_math.inc"
#include "core/localization/mix_lanes.inc"

/// column += value in the lanes that count.
HWY_INLINE void add_to(double* column, hn::Mask<Tag> counts, Lanes value) {
  const Tag d;
  hn::StoreU(hn::Add(hn::LoadU(d, column), hn::IfThenElseZero(counts, value)), d, column);
}

/// near_m, near_log: of one row; share, logs and sums: of its first fan.
HWY_INLINE void mix_row_of_beam(const double* near_m, const double* near_log, const double* share,
                                double* logs, const SingleBeams::Sums& sums) {
  const Tag d;
  for (std::size_t j = 0; j < RayFans::kVector; j += hn::Lanes(d)) {
    const auto is_met =
        hn::Lt(hn::LoadU(d, near_m + j), hn::Set(d, std::numeric_limits<double>::infinity()));
    if (hn::AllFalse(d, is_met)) continue;
    const auto near = hn::LoadU(d, near_log + j);
    const auto far = hn::LoadU(d, logs + j);
    const auto mixed = mix(hn::LoadU(d, share + j), near, far);
    hn::StoreU(hn::IfThenElse(is_met, mixed, far), d, logs + j);
    add_to(sums.near + j, is_met, hn::Sub(near, mixed));
    add_to(sums.far + j, is_met, hn::Sub(far, mixed));
    add_to(sums.beams + j, is_met, hn::Set(d, 1.0));
  }
}

void mix_single_lanes(std::span<const SingleRow> rows, const double* near_m, const double* near_log,
                      std::size_t fans, const double* share, double* logs,
                      const SingleBeams::Sums& sums) {
  for (std::size_t n = 0; n < rows.size(); ++n) {
    const std::size_t place = rows[n].box * fans + rows[n].fan;
    mix_row_of_beam(near_m + n * RayFans::kVector, near_log + n * RayFans::kVector, share + place,
                    logs + rows[n].beam * fans + rows[n].fan,
                    {sums.near + place, sums.far + place, sums.beams + place});
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
    for (auto* column : {&from_m_, &to_m_, &hidden_, &range_m_, &near_log_}) {
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
                      double* logs) {
  sum_columns_.assign(3 * share.size(), 0.0);
  sums_ = {sum_columns_.data(), sum_columns_.data() + share.size(),
           sum_columns_.data() + 2 * share.size()};
  const std::span<const SingleRow> rows(row_.data(), rows_.count);
  mixture.log_likelihoods_of_rows(rows, range_m_.data(), near_log_.data());
  HWY_DYNAMIC_DISPATCH(mix_single_lanes)
  (rows, range_m_.data(), near_log_.data(), fans, share.data(), logs, sums_);
}

}  // namespace strata::localization
#endif  // HWY_ONCE
