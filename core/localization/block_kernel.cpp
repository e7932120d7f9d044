// SPDX-License-Identifier: Apache-2.0
// Highway compiles this file once for each SIMD target and picks one at run time.
#include "core/localization/block_kernel.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/localization/block_kernel.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace strata::localization::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void sum_lanes(std::span<const std::uint8_t* const> rows, std::size_t count, std::uint16_t* sums) {
  const hn::CappedTag<std::uint16_t, 32> d;
  const hn::Rebind<std::uint8_t, decltype(d)> bytes;
  const std::size_t lanes = hn::Lanes(d);
  for (std::size_t i = 0; i < count; i += lanes) {
    auto a = hn::Zero(d);
    auto b = hn::Zero(d);
    std::size_t n = 0;
    for (; n + 2 <= rows.size(); n += 2) {
      a = hn::Add(a, hn::PromoteTo(d, hn::LoadU(bytes, rows[n] + i)));
      b = hn::Add(b, hn::PromoteTo(d, hn::LoadU(bytes, rows[n + 1] + i)));
    }
    if (n < rows.size()) a = hn::Add(a, hn::PromoteTo(d, hn::LoadU(bytes, rows[n] + i)));
    hn::StoreU(hn::Add(a, b), d, sums + i);
  }
}

}  // namespace strata::localization::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace strata::localization {

HWY_EXPORT(sum_lanes);

void sum_block_rows(std::span<const std::uint8_t* const> rows, std::size_t count,
                    std::uint16_t* sums) {
  HWY_DYNAMIC_DISPATCH(sum_lanes)(rows, count, sums);
}

void sum_block_rows_scalar(std::span<const std::uint8_t* const> rows, std::size_t count,
                           std::uint16_t* sums) {
  for (std::size_t i = 0; i < count; ++i) {
    std::uint16_t sum = 0;
    for (const std::uint8_t* row : rows) sum = static_cast<std::uint16_t>(sum + row[i]);
    sums[i] = sum;
  }
}

}  // namespace strata::localization
#endif  // HWY_ONCE
