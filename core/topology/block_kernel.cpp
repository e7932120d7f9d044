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
using Vector = hn::Vec<Lanes>;

/// (a[0] x + a[step] y) + a[2 step] z, each rounded by itself.
HWY_INLINE Vector in_a_row(const double* a, std::size_t step, Vector x, Vector y, Vector z) {
  const Lanes d;
  return hn::Add(hn::Add(hn::Mul(x, hn::Set(d, a[0])), hn::Mul(y, hn::Set(d, a[step]))),
                 hn::Mul(z, hn::Set(d, a[2 * step])));
}

/// block * inverse', in place.
HWY_INLINE void scale(const PaddedBlock& inverse, PaddedBlock& block) {
  const Lanes d;
  const double* a = inverse.data();
  for (std::size_t i = 0; i < kRows; i += hn::Lanes(d)) {
    double* at = block.data() + i;
    const auto x = hn::LoadU(d, at);
    const auto y = hn::LoadU(d, at + kRows);
    const auto z = hn::LoadU(d, at + 2 * kRows);
    hn::StoreU(hn::Mul(x, hn::Set(d, a[0])), d, at);
    hn::StoreU(hn::Add(hn::Mul(x, hn::Set(d, a[1])), hn::Mul(y, hn::Set(d, a[kRows + 1]))), d,
               at + kRows);
    hn::StoreU(in_a_row(a + 2, kRows, x, y, z), d, at + 2 * kRows);
  }
}

/// to -= block * other'
HWY_INLINE void subtract_product(const PaddedBlock& block, const PaddedBlock& other,
                                 PaddedBlock& to) {
  const Lanes d;
  for (std::size_t i = 0; i < kRows; i += hn::Lanes(d)) {
    const double* from = block.data() + i;
    const auto x = hn::LoadU(d, from);
    const auto y = hn::LoadU(d, from + kRows);
    const auto z = hn::LoadU(d, from + 2 * kRows);
    double* at = to.data() + i;
    for (std::size_t j = 0; j < 3; ++j, at += kRows) {
      hn::StoreU(hn::Sub(hn::LoadU(d, at), in_a_row(other.data() + j, kRows, x, y, z)), d, at);
    }
  }
}

void eliminate(std::size_t column, const PaddedBlock& inverse, const ColumnStarts& starts,
               PaddedBlock* diagonal, PaddedBlock* below) {
  const std::size_t begin = starts.begin[column];
  const std::size_t end = starts.begin[column + 1];
  for (std::size_t i = begin; i < end; ++i) scale(inverse, below[i]);
  for (std::size_t k = begin; k < end; ++k) {
    const auto row = static_cast<std::size_t>(starts.rows[k]);
    const PaddedBlock other = below[k];
    subtract_product(other, other, diagonal[row]);
    // Rows ascend in both columns: one way through the other finds each block.
    std::size_t at = starts.begin[row];
    for (std::size_t i = k + 1; i < end; ++i) {
      while (starts.rows[at] != starts.rows[i]) ++at;
      subtract_product(below[i], other, below[at]);
    }
  }
}

void transposed(std::span<const int> rows, const PaddedBlock* blocks, const PaddedBlock* x,
                PaddedBlock& sum) {
  const Lanes d;
  for (std::size_t i = 0; i < kRows; i += hn::Lanes(d)) {
    auto first = hn::LoadU(d, sum.data() + i);
    auto second = hn::LoadU(d, sum.data() + kRows + i);
    auto third = hn::LoadU(d, sum.data() + 2 * kRows + i);
    const PaddedBlock* block = blocks;
    for (const int row : rows) {
      const double* from = x[static_cast<std::size_t>(row)].data() + i;
      const auto u = hn::LoadU(d, from);
      const auto v = hn::LoadU(d, from + kRows);
      const auto w = hn::LoadU(d, from + 2 * kRows);
      const double* a = (block++)->data();
      first = hn::Sub(first, in_a_row(a, 1, u, v, w));
      second = hn::Sub(second, in_a_row(a + kRows, 1, u, v, w));
      third = hn::Sub(third, in_a_row(a + 2 * kRows, 1, u, v, w));
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

HWY_EXPORT(eliminate);
HWY_EXPORT(transposed);

void eliminate_column(std::size_t column, const PaddedBlock& inverse, const ColumnStarts& starts,
                      PaddedBlock* diagonal, PaddedBlock* below) {
  HWY_DYNAMIC_DISPATCH(eliminate)(column, inverse, starts, diagonal, below);
}

void subtract_transposed(std::span<const int> rows, const PaddedBlock* blocks, const PaddedBlock* x,
                         PaddedBlock& sum) {
  HWY_DYNAMIC_DISPATCH(transposed)(rows, blocks, x, sum);
}

}  // namespace strata::topology
#endif  // HWY_ONCE
