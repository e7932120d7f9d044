// SPDX-License-Identifier: Apache-2.0
// Highway compiles this file once for each SIMD target and picks one at run time.
#include "core/localization/ray_kernel.hpp"

#include <algorithm>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/localization/ray_kernel.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace strata::localization::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kMostLanes = 8;
using Tag = hn::CappedTag<double, kMostLanes>;
using Lanes = hn::Vec<Tag>;
using Floats = hn::Rebind<float, Tag>;
using Places = hn::Rebind<std::int32_t, Tag>;

/// One axis of the rays: where they start and how they cross the lattice lines. All in cells,
/// relative to the table's corner.
struct Axis {
  Lanes start, direction, inverse, step, line, size;

  HWY_INLINE Axis(Lanes start_cells, Lanes along, std::int32_t cells) {
    const Tag d;
    const auto zero = hn::Zero(d);
    const auto one = hn::Set(d, 1.0);
    start = start_cells;
    direction = along;
    size = hn::Set(d, static_cast<double>(cells));
    // A ray along the other axis never comes to the line above it.
    const auto is_down = hn::Lt(along, zero);
    inverse =
        hn::IfThenElse(hn::Eq(along, zero), hn::Set(d, std::numeric_limits<double>::infinity()),
                       hn::Div(one, along));
    step = hn::IfThenElse(is_down, hn::Set(d, -1.0), one);
    line = hn::IfThenElse(is_down, zero, one);
  }
  /// Cuts [t0, t1] to where the ray is inside the table.
  HWY_INLINE void clip(Lanes& t0, Lanes& t1) const {
    const Tag d;
    const auto zero = hn::Zero(d);
    const auto a = hn::Div(hn::Sub(zero, start), direction);
    const auto b = hn::Div(hn::Sub(size, start), direction);
    const auto is_still = hn::Eq(direction, zero);
    const auto is_outside = hn::Or(hn::Lt(start, zero), hn::Ge(start, size));
    const auto still_end = hn::IfThenElse(is_outside, hn::Set(d, -1.0), t1);
    t0 = hn::IfThenElse(is_still, t0, hn::Max(t0, hn::Min(a, b)));
    t1 = hn::IfThenElse(is_still, still_end, hn::Min(t1, hn::Max(a, b)));
  }
  [[nodiscard]] HWY_INLINE Lanes at(Lanes t) const { return hn::Add(start, hn::Mul(t, direction)); }
  [[nodiscard]] HWY_INLINE Lanes first_cell(Lanes t) const {
    const Tag d;
    const auto last = hn::Sub(size, hn::Set(d, 1.0));
    return hn::Min(hn::Max(hn::Floor(at(t)), hn::Zero(d)), last);
  }
  /// When the ray leaves cell i.
  [[nodiscard]] HWY_INLINE Lanes crossing(Lanes i) const {
    return hn::Mul(hn::Sub(hn::Add(i, line), start), inverse);
  }
  [[nodiscard]] HWY_INLINE hn::Mask<Tag> holds(Lanes i) const {
    return hn::And(hn::Ge(i, hn::Zero(Tag())), hn::Lt(i, size));
  }
};

/// A vector of rays, each lane at its own place: t cells along its ray, in cell (i, j). A lane that
/// is done stays where it is.
struct Rays {
  Axis x, y;
  Lanes t, end, i, j;
  Lanes met;  ///< -mark of the cell that was hit, where some are skipped
  hn::Mask<Tag> is_active, is_hit;

  /// from, to: in cells; cut to the table first unless they are inside.
  HWY_INLINE Rays(const Axis& x_axis, const Axis& y_axis, Lanes from, Lanes to, bool is_inside)
      : x(x_axis), y(y_axis), t(from), end(to) {
    const Tag d;
    if (!is_inside) {
      x.clip(t, end);
      y.clip(t, end);
    }
    is_active = hn::Lt(t, end);
    is_hit = hn::Lt(t, hn::Zero(d));  // none yet
    met = hn::Zero(d);
    i = x.first_cell(t);
    j = y.first_cell(t);
  }

  [[nodiscard]] HWY_INLINE Lanes place() const { return hn::Add(hn::Mul(j, x.size), i); }

  [[nodiscard]] HWY_INLINE Lanes leaps(const RayTable& table) const {
    const auto index = hn::DemoteTo(Places(), place());
    return hn::PromoteTo(Tag(), hn::GatherIndex(Floats(), table.leaps, index));
  }

  /// One step of RayWalker::walk in every lane that is not done.
  HWY_INLINE void step(const RayTable& table) {
    const auto leap = leaps(table);
    advance(leap, hn::Lt(leap, hn::Zero(Tag())));
  }
  /// The same through cells that are marked by `skipped`, -mark.
  HWY_INLINE void step(const RayTable& table, Lanes skipped) {
    const auto leap = leaps(table);
    const auto is_marked = hn::AndNot(hn::Eq(leap, skipped), hn::Lt(leap, hn::Zero(Tag())));
    met = hn::IfThenElse(hn::And(is_active, is_marked), leap, met);
    advance(leap, is_marked);
  }

  HWY_INLINE void advance(Lanes leap, hn::Mask<Tag> is_marked) {
    const Tag d;
    is_hit = hn::Or(is_hit, hn::And(is_active, is_marked));
    is_active = hn::AndNot(is_marked, is_active);
    const auto next_x = x.crossing(i);
    const auto next_y = y.crossing(j);
    const auto next = hn::Max(t, hn::Min(next_x, next_y));
    const auto is_leap = hn::Gt(leap, hn::Set(d, 1.0));
    const auto new_t = hn::IfThenElse(is_leap, hn::Add(t, leap), next);
    const auto step_i = hn::Add(i, hn::IfThenElseZero(hn::Le(next_x, next_y), x.step));
    const auto step_j = hn::Add(j, hn::IfThenElseZero(hn::Le(next_y, next_x), y.step));
    const auto new_i = hn::IfThenElse(is_leap, hn::Floor(x.at(new_t)), step_i);
    const auto new_j = hn::IfThenElse(is_leap, hn::Floor(y.at(new_t)), step_j);
    is_active = hn::And(is_active, hn::Lt(new_t, end));
    is_active = hn::And(is_active, hn::And(x.holds(new_i), y.holds(new_j)));
    t = hn::IfThenElse(is_active, new_t, t);
    i = hn::IfThenElse(is_active, new_i, i);
    j = hn::IfThenElse(is_active, new_j, j);
  }

  /// limit: the end of the beam in cells.
  [[nodiscard]] HWY_INLINE Lanes ranges(double resolution_m, Lanes limit) const {
    const Tag d;
    const auto resolution = hn::Set(d, resolution_m);
    const auto next = hn::Min(hn::Max(t, hn::Min(x.crossing(i), y.crossing(j))), limit);
    const auto middle =
        hn::Mul(hn::Set(d, 0.5), hn::Add(hn::Mul(t, resolution), hn::Mul(next, resolution)));
    return hn::IfThenElse(is_hit, middle, hn::Set(d, std::numeric_limits<double>::infinity()));
  }

  HWY_INLINE void store(double resolution_m, double* range_m, std::int32_t* cell) const {
    const Tag d;
    hn::StoreU(ranges(resolution_m, end), d, range_m);
    const auto found = hn::IfThenElse(is_hit, place(), hn::Set(d, -1.0));
    hn::StoreU(hn::DemoteTo(Places(), found), Places(), cell);
  }
};

/// Vectors that walk at the same time, so that one works while another waits for the table.
constexpr std::size_t kAbreast = 3;

/// Directions in the map of rays of a fan.
HWY_INLINE void directions(const RayFan& fan, const double* cosine, const double* sine, Lanes& c,
                           Lanes& s) {
  const Tag d;
  const auto hc = hn::Set(d, fan.heading_cosine);
  const auto hs = hn::Set(d, fan.heading_sine);
  const auto bc = hn::LoadU(d, cosine);
  const auto bs = hn::LoadU(d, sine);
  c = hn::Sub(hn::Mul(hc, bc), hn::Mul(hs, bs));
  s = hn::Add(hn::Mul(hs, bc), hn::Mul(hc, bs));
}

HWY_INLINE Rays rays_at(const RayTable& table, const RayFan& fan, const double* cosine,
                        const double* sine) {
  const Tag d;
  Lanes c, s;
  directions(fan, cosine, sine, c, s);
  const auto x = hn::Set(d, table.column_at(fan.x_m));
  const auto y = hn::Set(d, table.row_at(fan.y_m));
  return Rays(Axis(x, c, table.width), Axis(y, s, table.height), hn::Zero(d),
              hn::Set(d, fan.max_range_m / table.resolution_m), false);
}

/// kAbreast vectors of rays.
HWY_INLINE void cast_block(const RayTable& table, const RayFan& fan, const double* cosine,
                           const double* sine, double* range_m, std::int32_t* cell) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  static_assert(kAbreast == 3);
  Rays a = rays_at(table, fan, cosine, sine);
  Rays b = rays_at(table, fan, cosine + lanes, sine + lanes);
  Rays c = rays_at(table, fan, cosine + 2 * lanes, sine + 2 * lanes);
  while (!hn::AllFalse(d, hn::Or(hn::Or(a.is_active, b.is_active), c.is_active))) {
    a.step(table);
    b.step(table);
    c.step(table);
  }
  a.store(table.resolution_m, range_m, cell);
  b.store(table.resolution_m, range_m + lanes, cell + lanes);
  c.store(table.resolution_m, range_m + 2 * lanes, cell + 2 * lanes);
}

void cast_rays_lanes(const RayTable& table, const RayFan& fan, double* range_m,
                     std::int32_t* cell) {
  const std::size_t block = kAbreast * hn::Lanes(Tag());
  std::size_t k = 0;
  for (; k + block <= fan.count; k += block) {
    cast_block(table, fan, fan.cosine + k, fan.sine + k, range_m + k, cell + k);
  }
  if (k == fan.count) return;
  constexpr std::size_t kMost = kAbreast * kMostLanes;
  double cosine[kMost];
  double sine[kMost];
  std::fill(cosine, cosine + kMost, fan.cosine[k]);
  std::fill(sine, sine + kMost, fan.sine[k]);
  std::copy(fan.cosine + k, fan.cosine + fan.count, cosine);
  std::copy(fan.sine + k, fan.sine + fan.count, sine);
  double ranges[kMost];
  std::int32_t cells[kMost];
  cast_block(table, fan, cosine, sine, ranges, cells);
  std::copy(ranges, ranges + (fan.count - k), range_m + k);
  std::copy(cells, cells + (fan.count - k), cell + k);
}

/// One vector of a batch, which must hold as many rays from k on.
HWY_INLINE Rays rays_of(const RayTable& table, const RayBatch& batch, std::size_t k) {
  const Tag d;
  const auto per_m = hn::Set(d, 1.0 / table.resolution_m);
  return Rays(Axis(hn::LoadU(d, batch.column + k), hn::LoadU(d, batch.cosine + k), table.width),
              Axis(hn::LoadU(d, batch.row + k), hn::LoadU(d, batch.sine + k), table.height),
              hn::Mul(hn::LoadU(d, batch.from_m + k), per_m),
              hn::Mul(hn::LoadU(d, batch.to_m + k), per_m), true);
}

/// Two vectors abreast, from k on.
HWY_INLINE void cast_pair(const RayTable& table, const RayBatch& batch, std::size_t k,
                          double* range_m, std::int32_t* mark) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  Rays a = rays_of(table, batch, k);
  Rays b = rays_of(table, batch, k + lanes);
  const auto skip_a = hn::Neg(hn::LoadU(d, batch.skip + k));
  const auto skip_b = hn::Neg(hn::LoadU(d, batch.skip + k + lanes));
  while (!hn::AllFalse(d, hn::Or(a.is_active, b.is_active))) {
    a.step(table, skip_a);
    b.step(table, skip_b);
  }
  const auto limit = hn::Set(d, batch.max_range_m / table.resolution_m);
  const auto store = [&](const Rays& rays, std::size_t at) {
    hn::StoreU(rays.ranges(table.resolution_m, limit), d, range_m + at);
    hn::StoreU(hn::DemoteTo(Places(), hn::Neg(rays.met)), Places(), mark + at);
  };
  store(a, 0);
  store(b, lanes);
}

void cast_batch_lanes(const RayTable& table, const RayBatch& batch, double* range_m,
                      std::int32_t* mark) {
  const std::size_t block = 2 * hn::Lanes(Tag());
  std::size_t k = 0;
  for (; k + block <= batch.count; k += block) {
    cast_pair(table, batch, k, range_m + k, mark + k);
  }
  if (k == batch.count) return;
  // The last ones, filled up with copies of the first of them.
  constexpr std::size_t kMost = 2 * kMostLanes;
  double rest[7][kMost];
  const double* const columns[7] = {batch.column, batch.row,  batch.cosine, batch.sine,
                                    batch.from_m, batch.to_m, batch.skip};
  for (std::size_t c = 0; c < 7; ++c) {
    std::fill(rest[c], rest[c] + kMost, columns[c][k]);
    std::copy(columns[c] + k, columns[c] + batch.count, rest[c]);
  }
  const RayBatch last{rest[0], rest[1], rest[2], rest[3],          rest[4],
                      rest[5], rest[6], kMost,   batch.max_range_m};
  double ranges[kMost];
  std::int32_t marks[kMost];
  cast_pair(table, last, 0, ranges, marks);
  std::copy(ranges, ranges + (batch.count - k), range_m + k);
  std::copy(marks, marks + (batch.count - k), mark + k);
}

}  // namespace strata::localization::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace strata::localization {

HWY_EXPORT(cast_rays_lanes);
HWY_EXPORT(cast_batch_lanes);

void cast_rays(const RayTable& table, const RayFan& fan, double* range_m, std::int32_t* cell) {
  HWY_DYNAMIC_DISPATCH(cast_rays_lanes)(table, fan, range_m, cell);
}

void cast_batch(const RayTable& table, const RayBatch& batch, double* range_m, std::int32_t* mark) {
  HWY_DYNAMIC_DISPATCH(cast_batch_lanes)(table, batch, range_m, mark);
}

}  // namespace strata::localization
#endif  // HWY_ONCE
