// SPDX-License-Identifier: Apache-2.0
/// The inner loop of the likelihood field: for every particle the sum of a table over all end
/// points, with the widest SIMD that the machine has.
#pragma once

#include <cstddef>
#include <cstdint>

namespace strata::localization {

/// A table of whole numbers with a border, so that points outside need no test. Values lie row by
/// row; column 0 and the last, row 0 and the last are the border. Whole numbers, because their sum
/// does not depend on the order, and 16 bits, because the table should stay in the cache.
struct FieldTable {
  std::int32_t width = 0;   ///< with border
  std::int32_t height = 0;  ///< with border
  const std::uint16_t* values = nullptr;
};

/// Poses in units of cells, relative to the corner of the table. Arrays of `count`.
struct FieldPoses {
  const float* x = nullptr;
  const float* y = nullptr;
  const float* cosine = nullptr;
  const float* sine = nullptr;
  std::size_t count = 0;
};

/// End points in the frame of the pose, in units of cells. Arrays of `count`, at most 65,536.
struct FieldPoints {
  const float* x = nullptr;
  const float* y = nullptr;
  std::size_t count = 0;
};

/// sums[i] = sum over points of table[cell of pose_i * point]. The cells are found with separate
/// multiplications and additions, so every SIMD target and the scalar reference give the same
/// numbers. Lanes are points; the look-ups are plain loads, as gathers are slower than those on
/// some machines and hardly faster on others. Requires finite poses and points.
void sum_field(const FieldTable& table, const FieldPoses& poses, const FieldPoints& points,
               std::uint32_t* sums);
/// The same, one number at a time: the reference for tests.
void sum_field_scalar(const FieldTable& table, const FieldPoses& poses, const FieldPoints& points,
                      std::uint32_t* sums);

}  // namespace strata::localization
