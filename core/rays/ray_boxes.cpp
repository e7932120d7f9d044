// SPDX-License-Identifier: Apache-2.0
// Highway compiles this file once for each SIMD target and picks one at run time.
#include "core/rays/ray_boxes.hpp"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/rays/ray_boxes.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace strata::rays::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<double, BeamBundles::kVector>;
using Lanes = hn::Vec<Tag>;

/// A ray begins this far inside the cells of a box, whose edges lie a rounding outside of them.
constexpr double kInside_m = 1e-10;

/// One over a direction, far away but finite where the ray runs along the other axis: a rounding
/// from the edge of a box is as far as any ray goes.
HWY_INLINE Lanes finite_inverse(Lanes along) {
  const Tag d;
  const auto least = hn::Set(d, 1e-15);
  const auto is_small = hn::Lt(hn::Abs(along), least);
  return hn::Div(hn::Set(d, 1.0), hn::IfThenElse(is_small, least, along));
}

/// Rays of one beam, BeamBundles::kVector of them, and where they cross boxes.
struct Row {
  HWY_ALIGN double last_m[BeamBundles::kVector];  // where they end
  HWY_ALIGN double cosine[BeamBundles::kVector];
  HWY_ALIGN double sine[BeamBundles::kVector];
  HWY_ALIGN double inverse_cosine[BeamBundles::kVector];
  HWY_ALIGN double inverse_sine[BeamBundles::kVector];
  HWY_ALIGN double from_m[BeamBundles::kVector];
  HWY_ALIGN double to_m[BeamBundles::kVector];  // not beyond from_m: nowhere
  HWY_ALIGN double boxes[BeamBundles::kVector];
  HWY_ALIGN double others[BeamBundles::kVector];  // boxes that are not uniform
};

/// The directions of the bundles from n on. kAlone: all boxes are uniform, so that none of these
/// rays will be found in the row.
template <bool kAlone>
HWY_INLINE void begin_row(const BeamBundles& bundles, std::size_t beam, std::size_t n,
                          const double* end_m, Row& row) {
  const Tag d;
  const auto bc = hn::Set(d, bundles.cosine[beam]);
  const auto bs = hn::Set(d, bundles.sine[beam]);
  const auto limit = hn::Set(d, bundles.max_range_m);
  for (std::size_t j = 0; j < BeamBundles::kVector; j += hn::Lanes(d)) {
    const auto hc = hn::LoadU(d, bundles.heading_cosine + n + j);
    const auto hs = hn::LoadU(d, bundles.heading_sine + n + j);
    const auto c = hn::Sub(hn::Mul(hc, bc), hn::Mul(hs, bs));
    const auto s = hn::Add(hn::Mul(hs, bc), hn::Mul(hc, bs));
    hn::Store(hn::Min(hn::LoadU(d, end_m + n + j), limit), d, row.last_m + j);
    hn::Store(finite_inverse(c), d, row.inverse_cosine + j);
    hn::Store(finite_inverse(s), d, row.inverse_sine + j);
    if constexpr (kAlone) continue;
    hn::Store(c, d, row.cosine + j);
    hn::Store(s, d, row.sine + j);
    hn::Store(limit, d, row.from_m + j);
    for (double* const column : {row.to_m, row.boxes, row.others}) {
      hn::Store(hn::Zero(d), d, column + j);
    }
  }
}

/// Whether any of the bundles from n on goes as far as any box is away.
HWY_INLINE bool comes_to_any(std::span<const BoxColumns> boxes, std::size_t n,
                             const double* end_m) {
  const Tag d;
  for (const BoxColumns& box : boxes) {
    for (std::size_t j = 0; j < BeamBundles::kVector; j += hn::Lanes(d)) {
      const auto near = hn::LoadU(d, box.near_m + n + j);
      if (!hn::AllFalse(d, hn::Gt(hn::LoadU(d, end_m + n + j), near))) return true;
    }
  }
  return false;
}

/// Where they cross a box, for bundles from n on, into the row and into from_m and to_m; whether
/// any does.
template <bool kAlone>
HWY_INLINE bool cross_box(const BoxColumns& box, std::size_t n, Row& row, double* from_m,
                          double* to_m) {
  const Tag d;
  bool any = false;
  const auto name = hn::Set(d, box.name);
  const auto odd = hn::Set(d, box.is_uniform ? 0.0 : 1.0);
  for (std::size_t j = 0; j < BeamBundles::kVector; j += hn::Lanes(d)) {
    const auto last = hn::Load(d, row.last_m + j);
    const auto inverse_c = hn::Load(d, row.inverse_cosine + j);
    const auto inverse_s = hn::Load(d, row.inverse_sine + j);
    const auto counts = hn::Gt(last, hn::LoadU(d, box.near_m + n + j));
    const auto x0 = hn::Mul(hn::LoadU(d, box.min_x_m + n + j), inverse_c);
    const auto x1 = hn::Mul(hn::LoadU(d, box.max_x_m + n + j), inverse_c);
    const auto y0 = hn::Mul(hn::LoadU(d, box.min_y_m + n + j), inverse_s);
    const auto y1 = hn::Mul(hn::LoadU(d, box.max_y_m + n + j), inverse_s);
    const auto entry = hn::Max(hn::Max(hn::Min(x0, x1), hn::Min(y0, y1)), hn::Zero(d));
    const auto exit = hn::Min(hn::Min(hn::Max(x0, x1), hn::Max(y0, y1)), last);
    const auto crosses = hn::And(counts, hn::Lt(entry, exit));
    const auto begin = hn::Add(entry, hn::Set(d, kInside_m));
    hn::StoreU(hn::IfThenElseZero(crosses, begin), d, from_m + j);
    hn::StoreU(hn::IfThenElseZero(crosses, exit), d, to_m + j);
    if (hn::AllFalse(d, crosses)) continue;
    any = true;
    if constexpr (kAlone) continue;
    const auto from = hn::Load(d, row.from_m + j);
    const auto to = hn::Load(d, row.to_m + j);
    hn::Store(hn::IfThenElse(crosses, hn::Min(from, begin), from), d, row.from_m + j);
    hn::Store(hn::IfThenElse(crosses, hn::Max(to, exit), to), d, row.to_m + j);
    const auto add = [&](double* column, Lanes value) HWY_ATTR {
      hn::Store(hn::Add(hn::Load(d, column + j), hn::IfThenElseZero(crosses, value)), d,
                column + j);
    };
    add(row.boxes, name);
    add(row.others, odd);
  }
  return any;
}

/// Rays of the row that cross uniform boxes alone are those of `single` from `first` on; the others
/// are those of the row.
HWY_INLINE void part(Row& row, const SingleRows& single, std::size_t first) {
  const Tag d;
  for (std::size_t j = 0; j < BeamBundles::kVector; j += hn::Lanes(d)) {
    const auto has_others = hn::Gt(hn::Load(d, row.others + j), hn::Zero(d));
    const auto to = hn::Load(d, row.to_m + j);
    hn::Store(hn::IfThenElseZero(has_others, to), d, row.to_m + j);
    if (hn::AllFalse(d, has_others)) continue;
    for (std::size_t r = first; r < single.count; ++r) {
      double* const to_m = single.to_m + r * BeamBundles::kVector + j;
      hn::StoreU(hn::IfThenZeroElse(has_others, hn::LoadU(d, to_m)), d, to_m);
    }
  }
}

HWY_INLINE void keep(const double* values, hn::Mask<Tag> which, double* column) {
  hn::CompressStore(hn::Load(Tag(), values), which, Tag(), column);
}

HWY_INLINE void copy_row(const double* from, double* to) {
  const Tag d;
  for (std::size_t j = 0; j < BeamBundles::kVector; j += hn::Lanes(d)) {
    hn::StoreU(hn::LoadU(d, from + j), d, to + j);
  }
}

/// cross_boxes where all boxes are uniform, as most often: finds single rows only.
HWY_INLINE void cross_uniform_boxes(const BeamBundles& bundles, std::size_t beam,
                                    const double* end_m, std::span<const BoxColumns> boxes,
                                    SingleRows& single) {
  Row row;
  for (std::size_t n = 0; n < bundles.count; n += BeamBundles::kVector) {
    if (!comes_to_any(boxes, n, end_m)) continue;
    begin_row<true>(bundles, beam, n, end_m, row);
    for (const BoxColumns& box : boxes) {
      const std::size_t at = single.count * BeamBundles::kVector;
      if (!cross_box<true>(box, n, row, single.from_m + at, single.to_m + at)) continue;
      copy_row(box.hidden + n, single.hidden + at);
      single.rows[single.count++] = {static_cast<std::uint32_t>(beam),
                                     static_cast<std::uint32_t>(n), box.place};
    }
  }
}

std::size_t cross_boxes_lanes(const BeamBundles& bundles, std::size_t beam, const double* end_m,
                              std::span<const BoxColumns> boxes, const BoxCrossings& found,
                              SingleRows& single) {
  const auto is_uniform = [](const BoxColumns& box) { return box.is_uniform; };
  if (std::all_of(boxes.begin(), boxes.end(), is_uniform)) {
    cross_uniform_boxes(bundles, beam, end_m, boxes, single);
    return 0;
  }
  const Tag d;
  std::size_t count = 0;
  Row row;
  HWY_ALIGN double unused[2][BeamBundles::kVector];
  for (std::size_t n = 0; n < bundles.count; n += BeamBundles::kVector) {
    if (!comes_to_any(boxes, n, end_m)) continue;
    begin_row<false>(bundles, beam, n, end_m, row);
    const std::size_t first = single.count;
    bool any_other = false;
    for (const BoxColumns& box : boxes) {
      if (!box.is_uniform) {
        any_other = cross_box<false>(box, n, row, unused[0], unused[1]) || any_other;
        continue;
      }
      const std::size_t at = single.count * BeamBundles::kVector;
      if (!cross_box<false>(box, n, row, single.from_m + at, single.to_m + at)) continue;
      copy_row(box.hidden + n, single.hidden + at);
      single.rows[single.count++] = {static_cast<std::uint32_t>(beam),
                                     static_cast<std::uint32_t>(n), box.place};
    }
    if (!any_other) continue;
    part(row, single, first);
    for (std::size_t j = 0; j < BeamBundles::kVector; j += hn::Lanes(d)) {
      const auto crosses = hn::Lt(hn::Load(d, row.from_m + j), hn::Load(d, row.to_m + j));
      if (hn::AllFalse(d, crosses)) continue;
      hn::CompressStore(hn::Iota(d, static_cast<double>(n + j)), crosses, d, found.bundle + count);
      keep(row.cosine + j, crosses, found.cosine + count);
      keep(row.sine + j, crosses, found.sine + count);
      keep(row.from_m + j, crosses, found.from_m + count);
      keep(row.to_m + j, crosses, found.to_m + count);
      keep(row.boxes + j, crosses, found.boxes + count);
      count += hn::CountTrue(d, crosses);
    }
  }
  return count;
}

}  // namespace strata::rays::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace strata::rays {

HWY_EXPORT(cross_boxes_lanes);

std::size_t cross_boxes(const BeamBundles& bundles, std::size_t beam, const double* end_m,
                        std::span<const BoxColumns> boxes, const BoxCrossings& found,
                        SingleRows& single) {
  return HWY_DYNAMIC_DISPATCH(cross_boxes_lanes)(bundles, beam, end_m, boxes, found, single);
}

}  // namespace strata::rays
#endif  // HWY_ONCE
