// SPDX-License-Identifier: Apache-2.0
// Highway compiles this file once for each SIMD target and picks one at run time.
#include "core/topology/block_kernel.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/topology/block_kernel.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace strata::topology::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kRows = 4;  // with the one that is no part of the block
using Lanes = hn::CappedTag<double, kRows>;

/// (a[0] x + a[step] y) + a[2 step] z, each rounded by itself.
template <typename Vector>
HWY_INLINE Vector in_a_row(const double* a, std::size_t step, Vector x, Vector y, Vector z) {
  const Lanes d;
  return hn::Add(hn::Add(hn::Mul(x, hn::Set(d, a[0])), hn::Mul(y, hn::Set(d, a[step]))),
                 hn::Mul(z, hn::Set(d, a[2 * step])));
}

/// a[0] x + (a[3] y + a[6] z)
template <typename Vector>
HWY_INLINE Vector last_first(const double* a, Vector x, Vector y, Vector z) {
  const Lanes d;
  return hn::Add(hn::Mul(x, hn::Set(d, a[0])),
                 hn::Add(hn::Mul(y, hn::Set(d, a[3])), hn::Mul(z, hn::Set(d, a[6]))));
}

void products(const PaddedBlock& block, std::span<const FactorEntry> entries, PaddedBlock* left) {
  const Lanes d;
  for (std::size_t i = 0; i < kRows; i += hn::Lanes(d)) {
    const auto x = hn::LoadU(d, block.data() + i);
    const auto y = hn::LoadU(d, block.data() + kRows + i);
    const auto z = hn::LoadU(d, block.data() + 2 * kRows + i);
    const auto upper_two = hn::FirstN(d, i < 2 ? 2 - i : 0);
    for (const FactorEntry& entry : entries) {
      double* to = left[static_cast<std::size_t>(entry.row)].data() + i;
      const double* a = entry.value.data();
      for (std::size_t j = 0; j < 3; ++j, to += kRows, ++a) {
        const auto sum = hn::IfThenElse(upper_two, in_a_row(a, 3, x, y, z), last_first(a, x, y, z));
        hn::StoreU(hn::Sub(hn::LoadU(d, to), sum), d, to);
      }
    }
  }
}

void transposed(std::span<const FactorEntry> entries, const PaddedBlock* x, PaddedBlock& sum) {
  const Lanes d;
  for (std::size_t i = 0; i < kRows; i += hn::Lanes(d)) {
    auto first = hn::LoadU(d, sum.data() + i);
    auto second = hn::LoadU(d, sum.data() + kRows + i);
    auto third = hn::LoadU(d, sum.data() + 2 * kRows + i);
    for (const FactorEntry& entry : entries) {
      const double* from = x[static_cast<std::size_t>(entry.row)].data() + i;
      const auto u = hn::LoadU(d, from);
      const auto v = hn::LoadU(d, from + kRows);
      const auto w = hn::LoadU(d, from + 2 * kRows);
      const double* a = entry.value.data();
      first = hn::Sub(first, in_a_row(a, 1, u, v, w));
      second = hn::Sub(second, in_a_row(a + 3, 1, u, v, w));
      third = hn::Sub(third, in_a_row(a + 6, 1, u, v, w));
    }
    hn::StoreU(first, d, sum.data() + i);
    hn::StoreU(second, d, sum.data() + kRows + i);
    hn::StoreU(third, d, sum.data() + 2 * kRows + i);
  }
}

}  // namespace strata::topology::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace strata::topology {

HWY_EXPORT(products);
HWY_EXPORT(transposed);

void subtract_products(const PaddedBlock& block, std::span<const FactorEntry> entries,
                       PaddedBlock* left) {
  HWY_DYNAMIC_DISPATCH(products)(block, entries, left);
}

void subtract_transposed(std::span<const FactorEntry> entries, const PaddedBlock* x,
                         PaddedBlock& sum) {
  HWY_DYNAMIC_DISPATCH(transposed)(entries, x, sum);
}

}  // namespace strata::topology
#endif  // HWY_ONCE
