// SPDX-License-Identifier: Apache-2.0
// Highway compiles this file once for each SIMD target and picks one at run time.
#include "core/localization/column_math.hpp"

#include <algorithm>
#include <numbers>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/localization/column_math.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace strata::localization::HWY_NAMESPACE {
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

}  // namespace strata::localization::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace strata::localization {

HWY_EXPORT(exp_column_lanes);
HWY_EXPORT(log_column_lanes);

void exp_column(double* values, std::size_t count) {
  HWY_DYNAMIC_DISPATCH(exp_column_lanes)(values, count);
}
void log_column(double* values, std::size_t count) {
  HWY_DYNAMIC_DISPATCH(log_column_lanes)(values, count);
}

}  // namespace strata::localization
#endif  // HWY_ONCE
