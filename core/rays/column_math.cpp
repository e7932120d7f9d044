// SPDX-License-Identifier: Apache-2.0
// Highway compiles this file once for each SIMD target and picks one at run time.
#include "core/rays/column_math.hpp"

#include <algorithm>
#include <numbers>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/rays/column_math.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace strata::rays::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
#include "core/base/lane_math.inc"

/// Replaces vector by vector; the last ones in a row that zeros fill up.
template <class Function>
HWY_INLINE void replace(double* values, std::size_t count, Function&& function) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  std::size_t k = 0;
  for (; k + lanes <= count; k += lanes) {
    hn::StoreU(function(hn::LoadU(d, values + k)), d, values + k);
  }
  if (k == count) return;
  double rest[kParts] = {};
  std::copy(values + k, values + count, rest);
  hn::StoreU(function(hn::LoadU(d, rest)), d, rest);
  std::copy(rest, rest + (count - k), values + k);
}

void exp_column_lanes(double* values, std::size_t count) {
  replace(values, count, [](Lanes x) { return exp_of(Tag(), x); });
}

void log_column_lanes(double* values, std::size_t count) {
  replace(values, count, [](Lanes x) { return log_of(Tag(), hn::Max(x, hn::Set(Tag(), 1e-300))); });
}

#include "core/rays/mix_lanes.inc"

void mix_lanes(const double* share, const double* first, const double* second, std::size_t count,
               double* mixed) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  std::size_t k = 0;
  for (; k + lanes <= count; k += lanes) {
    hn::StoreU(mix(hn::LoadU(d, share + k), hn::LoadU(d, first + k), hn::LoadU(d, second + k)), d,
               mixed + k);
  }
  if (k == count) return;
  double rest[3][kParts] = {};
  std::copy(share + k, share + count, rest[0]);
  std::copy(first + k, first + count, rest[1]);
  std::copy(second + k, second + count, rest[2]);
  hn::StoreU(mix(hn::LoadU(d, rest[0]), hn::LoadU(d, rest[1]), hn::LoadU(d, rest[2])), d, rest[0]);
  std::copy(rest[0], rest[0] + (count - k), mixed + k);
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

/// One vector of columns.
template <class D>
HWY_INLINE void sum_columns(D d, const double* values, std::size_t rows, std::size_t stride,
                            double* sums) {
  auto sum = hn::Zero(d);
  for (std::size_t r = 0; r < rows; ++r) sum = hn::Add(sum, hn::LoadU(d, values + r * stride));
  hn::StoreU(sum, d, sums);
}

void sum_row_lanes(const double* values, std::size_t rows, std::size_t columns, double* sums) {
  const std::size_t lanes = hn::Lanes(Tag());
  std::size_t k = 0;
  for (; k + lanes <= columns; k += lanes) sum_columns(Tag(), values + k, rows, columns, sums + k);
  const hn::CappedTag<double, 1> one;
  for (; k < columns; ++k) sum_columns(one, values + k, rows, columns, sums + k);
}

}  // namespace strata::rays::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace strata::rays {

HWY_EXPORT(exp_column_lanes);
HWY_EXPORT(log_column_lanes);
HWY_EXPORT(mix_lanes);
HWY_EXPORT(mix_row_lanes);
HWY_EXPORT(sum_row_lanes);

void exp_column(double* values, std::size_t count) {
  HWY_DYNAMIC_DISPATCH(exp_column_lanes)(values, count);
}
void log_column(double* values, std::size_t count) {
  HWY_DYNAMIC_DISPATCH(log_column_lanes)(values, count);
}

void mix_logs(const double* share, const double* first, const double* second, std::size_t count,
              double* mixed) {
  HWY_DYNAMIC_DISPATCH(mix_lanes)(share, first, second, count, mixed);
}

void mix_rows(std::span<const double> weight, const double* logs, std::size_t stride,
              std::size_t count, double* mixed) {
  HWY_DYNAMIC_DISPATCH(mix_row_lanes)(weight, logs, stride, count, mixed);
}

void sum_rows(const double* values, std::size_t rows, std::size_t columns, double* sums) {
  HWY_DYNAMIC_DISPATCH(sum_row_lanes)(values, rows, columns, sums);
}

}  // namespace strata::rays
#endif  // HWY_ONCE
