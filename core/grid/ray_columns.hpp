// SPDX-License-Identifier: Apache-2.0
/// The cells that a ray crosses, many at a time, with the widest SIMD that the machine has.
#pragma once

#include <cstddef>

namespace strata::detail {

/// The lattice lines that a ray crosses, those of its longer axis a and of the other axis b, in
/// cells. Line i of an axis is crossed at ((line + i step) - start) inverse of the ray: worked out
/// for each line afresh, so that errors do not add up.
struct RayLines {
  double start_a = 0.0, line_a = 0.0, step_a = 1.0, inverse_a = 0.0;
  double start_b = 0.0, line_b = 0.0, step_b = 1.0, inverse_b = 0.0;
  int left_a = 0;  ///< how many there are to cross
  int left_b = 0;
  double along_b = 0.0;  ///< how far the ray goes along b
  double length_m = 0.0;
};

/// A ray on its way through a grid. Between one line of a and the next it is in one column.
struct RayColumns {
  RayLines lines;      ///< of the whole ray
  double first = 0.0;  ///< number of the first cell; all numbers are below 2^52
  double major = 0.0;  ///< what a step along a adds to it, what one along b
  double minor = 0.0;
  // Where it is: in this column, entered at t of the ray after crossed_b lines of b.
  int column = 0;
  int crossed_b = 0;
  double t = 0.0;
};

/// A cell's number, as the bits of a double, and the length inside it in metres.
struct alignas(16) RayCell {
  double number;
  double length_m;
};
/// Cells in the order of the ray.
struct RayCells {
  static constexpr std::size_t kColumns = 128;  ///< of one call
  RayCell cell[2 * kColumns + 8];               // a vector's worth may follow the last one
};

/// Fills `cells` with those of the next columns, moves `ray` on and returns how many they are. 0 at
/// the end of the ray, and where the ray comes so close to a corner that rounding decides which
/// line is crossed first; the caller takes it from there one cell at a time, as on machines without
/// four lanes of double. The same bits on every machine. Requires finite numbers.
std::size_t next_cells(RayColumns& ray, RayCells& cells);

}  // namespace strata::detail
