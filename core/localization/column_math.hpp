// SPDX-License-Identifier: Apache-2.0
/// Exponentials and logarithms of whole columns, with the widest SIMD that the machine has.
#pragma once

#include <cstddef>

namespace strata::localization {

/// values[k] becomes e^values[k] for k < count, 0 below -700 and for NaN; values up to 700. Within
/// a few units in the last place; every SIMD target gives the same bits.
void exp_column(double* values, std::size_t count);

/// values[k] becomes ln values[k] for k < count, and no less than ln 1e-300; finite values. The
/// same precision and bits.
void log_column(double* values, std::size_t count);

}  // namespace strata::localization
