// SPDX-License-Identifier: Apache-2.0
/// Exponentials and logarithms of whole columns, with the widest SIMD that the machine has.
#pragma once

#include <cstddef>
#include <span>

namespace strata::rays {

/// values[k] becomes e^values[k] for k < count, 0 below -700 and for NaN; values up to 700. Within
/// a few units in the last place; every SIMD target gives the same bits.
void exp_column(double* values, std::size_t count);

/// values[k] becomes ln values[k] for k < count, and no less than ln 1e-300; finite values. The
/// same precision and bits.
void log_column(double* values, std::size_t count);

/// mixed[k] = ln(share[k] e^first[k] + (1 - share[k]) e^second[k]), 0 <= share <= 1, one of the two
/// finite. Every SIMD target gives the same bits.
void mix_logs(const double* share, const double* first, const double* second, std::size_t count,
              double* mixed);

/// mixed[k] = ln sum_r weight[r] e^logs[r stride + k] for k < count, and no less than ln 1e-300;
/// logs below 700. mixed may be the first row. Every SIMD target gives the same bits.
void mix_rows(std::span<const double> weight, const double* logs, std::size_t stride,
              std::size_t count, double* mixed);

/// sums[k] = the sum over r of values[r columns + k], in order of rows: the same bits on every SIMD
/// target.
void sum_rows(const double* values, std::size_t rows, std::size_t columns, double* sums);

}  // namespace strata::rays
