// SPDX-License-Identifier: Apache-2.0
// Highway compiles this file once for each SIMD target and picks one at run time.
#include "core/grid/ray_columns.hpp"

#include <algorithm>
#include <cstdint>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/grid/ray_columns.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace strata::detail::HWY_NAMESPACE {
// Four lanes of double are faster than one cell after the other, two are not (docs/benchmarks.md).
// Better targets have smaller numbers, and those of other processors than x86-64 greater ones.
#if HWY_TARGET > HWY_AVX2

std::size_t next_cells_lanes(RayColumns& /*ray*/, RayCells& /*cells*/) { return 0; }

#else
namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kLanes = 4;
using Tag = hn::FixedTag<double, kLanes>;
using Lanes = hn::Vec<Tag>;

/// Nearer than this to a corner, in cells, rounding may decide: far more than it amounts to among
/// cells whose coordinates are int.
constexpr double kNear = 1e-5;

/// Entry 0 is where the first column is entered, entry k + 1 where column k is left: at `t` of the
/// ray, after `crossed` lines of b.
struct Columns {
  static constexpr std::size_t kRoom = RayCells::kColumns + kLanes + 1;
  double t[kRoom];
  double crossed[kRoom];
};

/// Rounding may put a crossing a hair outside the ray.
HWY_INLINE Lanes cut_to_ray(Lanes crossing) {
  const Tag d;
  return hn::Max(hn::Min(crossing, hn::Set(d, 1.0)), hn::Zero(d));
}

/// Fills `columns` for the next `count` and as many as fill up a vector. False near a corner.
HWY_INLINE bool leave_columns(const RayColumns& ray, std::size_t count, Columns& columns) {
  const Tag d;
  const RayLines& lines = ray.lines;
  // The lines of b crossed by t are as many as there are whole numbers from 1 to
  // t slope + offset + 0.5. Added to 1.5 2^52, a number is rounded to a whole one.
  const bool is_straight = lines.left_b == 0;
  const auto slope = hn::Set(d, is_straight ? 0.0 : lines.along_b * lines.step_b);
  const auto offset =
      hn::Set(d, is_straight ? 0.0 : (lines.start_b - lines.line_b) * lines.step_b + 0.5);
  const auto whole = hn::Set(d, 0x1.8p52);
  const auto start = hn::Set(d, lines.start_a);
  const auto inverse = hn::Set(d, lines.inverse_a);
  const auto number = hn::Iota(d, static_cast<double>(ray.column));
  auto line = hn::Add(hn::Set(d, lines.line_a), hn::Mul(number, hn::Set(d, lines.step_a)));
  const auto next_line = hn::Set(d, static_cast<double>(kLanes) * lines.step_a);
  auto furthest = hn::Zero(d);
  columns.t[0] = ray.t;
  columns.crossed[0] = ray.crossed_b;
  for (std::size_t k = 0; k < count; k += kLanes) {
    const auto t = hn::Mul(hn::Sub(line, start), inverse);
    const auto all = hn::Add(hn::Mul(t, slope), offset);
    const auto crossed = hn::Sub(hn::Add(all, whole), whole);
    furthest = hn::Max(furthest, hn::Abs(hn::Sub(all, crossed)));
    hn::StoreU(cut_to_ray(t), d, columns.t + k + 1);
    hn::StoreU(crossed, d, columns.crossed + k + 1);
    line = hn::Add(line, next_line);
  }
  return hn::AllTrue(d, hn::Lt(furthest, hn::Set(d, 0.5 - kNear)));
}

/// Where the cells of four columns go, in bytes behind those of the columns before: entry [m][k] is
/// for column k if the columns in m are crossed by a line of b; entry [m][4], behind all of them.
struct Places {
  std::uint8_t behind[16][8];
};
constexpr Places places() {
  Places result{};
  for (unsigned m = 0; m < 16; ++m) {
    std::uint8_t place = 0;
    for (unsigned k = 0; k < kLanes + 1; ++k) {
      result.behind[m][k] = place;
      place = static_cast<std::uint8_t>(place + sizeof(RayCell) * (1 + (m >> k & 1U)));
    }
  }
  return result;
}
alignas(64) constexpr Places kPlaces = places();

/// One of the two cells of a vector, number and length.
template <std::size_t kCell>
HWY_INLINE void store_cell(Lanes cells, RayCell* to) {
  const hn::Half<Tag> d;
  if constexpr (kCell == 0) {
    hn::StoreU(hn::LowerHalf(d, cells), d, &to->number);
  } else {
    hn::StoreU(hn::UpperHalf(d, cells), d, &to->number);
  }
}

/// Cells of columns, `near` and behind it `far`, and the lengths in them.
struct ColumnCells {
  Lanes near, near_m, far, far_m;

  /// Stores both of column kColumn. What is behind a line that is not crossed is overwritten by the
  /// next column.
  template <std::size_t kColumn>
  HWY_INLINE void store(RayCell* to) const {
    const Tag d;
    if constexpr (kColumn % 2 == 0) {
      store_cell<kColumn / 2>(hn::InterleaveLower(d, near, near_m), to);
      store_cell<kColumn / 2>(hn::InterleaveLower(d, far, far_m), to + 1);
    } else {
      store_cell<kColumn / 2>(hn::InterleaveUpper(d, near, near_m), to);
      store_cell<kColumn / 2>(hn::InterleaveUpper(d, far, far_m), to + 1);
    }
  }
};

HWY_INLINE RayCell* at(RayCell* cell, std::uint8_t bytes) {
  return reinterpret_cast<RayCell*>(reinterpret_cast<char*>(cell) + bytes);
}

HWY_INLINE std::size_t bits_of(hn::Mask<Tag> mask) {
  std::uint8_t bits[8] = {};
  hn::StoreMaskBits(Tag(), mask, bits);
  return bits[0];
}

/// The cells of `count` columns, whole vectors: one of each, two where a line of b is crossed. A
/// column is never longer along b than along a, so more than that is only possible near corners.
HWY_INLINE std::size_t list_cells(const RayColumns& ray, const Columns& columns, std::size_t count,
                                  RayCells& cells) {
  const Tag d;
  const hn::RebindToUnsigned<Tag> du;
  const RayLines& lines = ray.lines;
  const auto length = hn::Set(d, lines.length_m);
  const auto minor = hn::Set(d, ray.minor);
  const auto line_b = hn::Set(d, lines.line_b);
  const auto step_b = hn::Set(d, lines.step_b);
  const auto start_b = hn::Set(d, lines.start_b);
  const auto inverse_b = hn::Set(d, lines.inverse_b);
  // Whole numbers below 2^52 in the mantissa of 2^52.
  const auto mantissa = hn::Set(du, 0x000FFFFFFFFFFFFFULL);
  auto base = hn::Add(hn::Set(d, 0x1p52 + (ray.first + ray.column * ray.major)),
                      hn::Mul(hn::Iota(d, 0.0), hn::Set(d, ray.major)));
  const auto next_base = hn::Set(d, static_cast<double>(kLanes) * ray.major);
  RayCell* to = cells.cell;
  for (std::size_t k = 0; k < count; k += kLanes) {
    const auto row = hn::LoadU(d, columns.crossed + k);
    const auto crosses = hn::Gt(hn::LoadU(d, columns.crossed + k + 1), row);
    const auto t = hn::LoadU(d, columns.t + k);
    const auto t_end = hn::LoadU(d, columns.t + k + 1);
    const auto line = hn::Add(line_b, hn::Mul(row, step_b));
    const auto crossing = cut_to_ray(hn::Mul(hn::Sub(line, start_b), inverse_b));
    const auto middle = hn::IfThenElse(crosses, crossing, t_end);
    const auto cell = hn::Add(base, hn::Mul(row, minor));
    const ColumnCells found{
        hn::BitCast(d, hn::And(hn::BitCast(du, cell), mantissa)),
        hn::Mul(hn::Sub(middle, t), length),
        hn::BitCast(d, hn::And(hn::BitCast(du, hn::Add(cell, minor)), mantissa)),
        hn::Mul(hn::Sub(t_end, middle), length)};
    const std::uint8_t* const behind = kPlaces.behind[bits_of(crosses)];
    found.store<0>(at(to, behind[0]));
    found.store<1>(at(to, behind[1]));
    found.store<2>(at(to, behind[2]));
    found.store<3>(at(to, behind[3]));
    to = at(to, behind[kLanes]);
    base = hn::Add(base, next_base);
  }
  return static_cast<std::size_t>(to - cells.cell);
}

std::size_t next_cells_lanes(RayColumns& ray, RayCells& cells) {
  if (ray.column > ray.lines.left_a) return 0;
  const auto left = static_cast<std::size_t>(ray.lines.left_a - ray.column) + 1;
  const std::size_t count = std::min(left, RayCells::kColumns);
  const std::size_t whole = (count + kLanes - 1) / kLanes * kLanes;
  Columns columns;
  if (!leave_columns(ray, count, columns)) return 0;
  if (count == left) {
    // The last column goes to the end of the ray. Behind it nothing is crossed: one cell each.
    columns.t[count] = 1.0;
    std::fill(columns.crossed + count, columns.crossed + whole + 1,
              static_cast<double>(ray.lines.left_b));
  }
  const std::size_t found = list_cells(ray, columns, whole, cells) - (whole - count);
  ray.column += static_cast<int>(count);
  ray.crossed_b = static_cast<int>(columns.crossed[count]);
  ray.t = columns.t[count];
  return found;
}
#endif  // HWY_TARGET

}  // namespace strata::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace strata::detail {

HWY_EXPORT(next_cells_lanes);

std::size_t next_cells(RayColumns& ray, RayCells& cells) {
  return HWY_DYNAMIC_DISPATCH(next_cells_lanes)(ray, cells);
}

}  // namespace strata::detail
#endif  // HWY_ONCE
