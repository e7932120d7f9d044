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
#if HWY_TARGET == HWY_SCALAR

std::size_t next_cells_lanes(RayColumns& /*ray*/, RayCells& /*cells*/) { return 0; }

#else
namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kMaxLanes = 8;
using Tag = hn::CappedTag<double, kMaxLanes>;
using Lanes = hn::Vec<Tag>;

/// Nearer than this to a corner, in cells, rounding may decide: far more than it amounts to among
/// cells whose coordinates are int.
constexpr double kNear = 1e-5;

/// Entry 0 is where the first column is entered, entry k + 1 where column k is left: at `t` of the
/// ray, after `crossed` lines of b.
struct Columns {
  static constexpr std::size_t kRoom = RayCells::kColumns + kMaxLanes + 1;
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
  // The lines of b crossed by t are as many as there are whole numbers from 1 to t slope + offset.
  const bool is_straight = lines.left_b == 0;
  const auto slope = hn::Set(d, is_straight ? 0.0 : lines.along_b * lines.step_b);
  const auto offset =
      hn::Set(d, is_straight ? 0.5 : (lines.start_b - lines.line_b) * lines.step_b + 1.0);
  const auto start = hn::Set(d, lines.start_a);
  const auto inverse = hn::Set(d, lines.inverse_a);
  const auto half = hn::Set(d, 0.5);
  const auto number = hn::Iota(d, static_cast<double>(ray.column));
  auto line = hn::Add(hn::Set(d, lines.line_a), hn::Mul(number, hn::Set(d, lines.step_a)));
  const auto next_line = hn::Set(d, static_cast<double>(hn::Lanes(d)) * lines.step_a);
  auto furthest = hn::Zero(d);
  columns.t[0] = ray.t;
  columns.crossed[0] = ray.crossed_b;
  for (std::size_t k = 0; k < count; k += hn::Lanes(d)) {
    const auto t = hn::Mul(hn::Sub(line, start), inverse);
    const auto all = hn::Add(hn::Mul(t, slope), offset);
    const auto crossed = hn::Floor(all);
    furthest = hn::Max(furthest, hn::Abs(hn::Sub(hn::Sub(all, crossed), half)));
    hn::StoreU(cut_to_ray(t), d, columns.t + k + 1);
    hn::StoreU(crossed, d, columns.crossed + k + 1);
    line = hn::Add(line, next_line);
  }
  return hn::AllTrue(d, hn::Lt(furthest, hn::Set(d, 0.5 - kNear)));
}

/// Lane n stands for column order[n] of a vector: then interleaving two vectors, which goes by
/// blocks of two lanes, gives the columns in their order.
struct Order {
  HWY_ALIGN std::int64_t of[kMaxLanes];
  HWY_ALIGN double number[kMaxLanes];
  Order() {
    const std::size_t lanes = hn::Lanes(Tag());
    for (std::size_t n = 0; n < lanes; ++n) {
      of[n] = static_cast<std::int64_t>(n % 2 == 0 ? n / 2 : (lanes + n) / 2);
      number[n] = static_cast<double>(of[n]);
    }
  }
};

/// The cells of `count` columns, whole vectors: one of each, two where a line of b is crossed. A
/// column is never longer along b than along a, so more than that is only possible near corners.
HWY_INLINE std::size_t list_cells(const RayColumns& ray, const Columns& columns, std::size_t count,
                                  RayCells& cells) {
  const Tag d;
  const hn::RebindToUnsigned<Tag> du;
  const RayLines& lines = ray.lines;
  const Order order;
  const auto indices = hn::SetTableIndices(d, order.of);
  const auto load = [&](const double* from) {
    return hn::TableLookupLanes(hn::LoadU(d, from), indices);
  };
  const auto zero = hn::Zero(d);
  const auto one = hn::Set(d, 1.0);
  const auto length = hn::Set(d, lines.length_m);
  const auto minor = hn::Set(d, ray.minor);
  const auto line_b = hn::Set(d, lines.line_b);
  const auto step_b = hn::Set(d, lines.step_b);
  const auto start_b = hn::Set(d, lines.start_b);
  const auto inverse_b = hn::Set(d, lines.inverse_b);
  // Whole numbers below 2^52 in the mantissa of 2^52.
  const auto mantissa = hn::Set(du, 0x000FFFFFFFFFFFFFULL);
  auto base = hn::Add(hn::Set(d, 0x1p52 + (ray.first + ray.column * ray.major)),
                      hn::Mul(hn::Load(d, order.number), hn::Set(d, ray.major)));
  const auto next_base = hn::Set(d, static_cast<double>(hn::Lanes(d)) * ray.major);
  std::size_t found = 0;
  const auto add = [&](Lanes cell, Lanes inside_m, Lanes counts) {
    const auto is_there = hn::Gt(counts, zero);
    hn::CompressStore(inside_m, is_there, d, cells.length_m + found);
    found += hn::CompressStore(cell, is_there, d, cells.number + found);
  };
  for (std::size_t k = 0; k < count; k += hn::Lanes(d)) {
    const auto row = load(columns.crossed + k);
    const auto crosses = hn::Sub(load(columns.crossed + k + 1), row);
    const auto t = load(columns.t + k);
    const auto t_end = load(columns.t + k + 1);
    const auto line = hn::Add(line_b, hn::Mul(row, step_b));
    const auto crossing = cut_to_ray(hn::Mul(hn::Sub(line, start_b), inverse_b));
    const auto middle = hn::IfThenElse(hn::Gt(crosses, zero), crossing, t_end);
    const auto cell = hn::Add(base, hn::Mul(row, minor));
    const auto near = hn::BitCast(d, hn::And(hn::BitCast(du, cell), mantissa));
    const auto far = hn::BitCast(d, hn::And(hn::BitCast(du, hn::Add(cell, minor)), mantissa));
    const auto near_m = hn::Mul(hn::Sub(middle, t), length);
    const auto far_m = hn::Mul(hn::Sub(t_end, middle), length);
    add(hn::InterleaveLower(d, near, far), hn::InterleaveLower(d, near_m, far_m),
        hn::InterleaveLower(d, one, crosses));
    add(hn::InterleaveUpper(d, near, far), hn::InterleaveUpper(d, near_m, far_m),
        hn::InterleaveUpper(d, one, crosses));
    base = hn::Add(base, next_base);
  }
  return found;
}

std::size_t next_cells_lanes(RayColumns& ray, RayCells& cells) {
  if (ray.column > ray.lines.left_a) return 0;
  const auto left = static_cast<std::size_t>(ray.lines.left_a - ray.column) + 1;
  const std::size_t count = std::min(left, RayCells::kColumns);
  const std::size_t lanes = hn::Lanes(Tag());
  const std::size_t whole = (count + lanes - 1) / lanes * lanes;
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
