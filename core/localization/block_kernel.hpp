// SPDX-License-Identifier: Apache-2.0
/// The inner loop of the global search: sums of rows of bytes, with the widest SIMD that the
/// machine has.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace strata::localization {

/// sums[i] = sum over rows of row[i], for i < count. Whole vectors are read and written: up to 63
/// places more are read of each row and overwritten in sums. Requires at most 257 rows.
void sum_block_rows(std::span<const std::uint8_t* const> rows, std::size_t count,
                    std::uint16_t* sums);
/// The same, one number at a time, and nothing beyond count: the reference for tests.
void sum_block_rows_scalar(std::span<const std::uint8_t* const> rows, std::size_t count,
                           std::uint16_t* sums);

}  // namespace strata::localization
