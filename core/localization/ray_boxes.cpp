// SPDX-License-Identifier: Apache-2.0
// Highway compiles this file once for each SIMD target and picks one at run time.
#include "core/localization/ray_boxes.hpp"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/localization/ray_boxes.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace strata::localization::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<double, RayCrossings::kSlack>;
using Lanes = hn::Vec<Tag>;

/// One over a direction, far away but finite where the ray runs along the other axis.
HWY_INLINE Lanes finite_inverse(Lanes along) {
  const Tag d;
  const auto least = hn::Set(d, 1e-12);
  const auto is_small = hn::Lt(hn::Abs(along), least);
  return hn::Div(hn::Set(d, 1.0), hn::IfThenElse(is_small, least, along));
}

std::size_t cross_boxes_lanes(const RayFan& fan, const double* end_m, const RayBox* boxes,
                              std::size_t box_count, const RayCrossings& found) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  const auto zero = hn::Zero(d);
  const auto hc = hn::Set(d, fan.heading_cosine);
  const auto hs = hn::Set(d, fan.heading_sine);
  std::size_t count = 0;
  const auto cross = [&](std::size_t k, const double* cosine, const double* sine,
                         const double* end) {
    const auto last = hn::Min(hn::LoadU(d, end), hn::Set(d, fan.max_range_m));
    const auto bc = hn::LoadU(d, cosine);
    const auto bs = hn::LoadU(d, sine);
    const auto c = hn::Sub(hn::Mul(hc, bc), hn::Mul(hs, bs));
    const auto s = hn::Add(hn::Mul(hs, bc), hn::Mul(hc, bs));
    const auto inverse_c = finite_inverse(c);
    const auto inverse_s = finite_inverse(s);
    auto from = hn::Set(d, fan.max_range_m);
    auto to = zero;
    auto crossed = zero;
    double power = 1.0;
    for (std::size_t b = 0; b < box_count; ++b, power *= 2.0) {
      if (hn::AllFalse(d, hn::Gt(last, hn::Set(d, boxes[b].near_m)))) continue;
      const auto x0 = hn::Mul(hn::Set(d, boxes[b].min_x_m), inverse_c);
      const auto x1 = hn::Mul(hn::Set(d, boxes[b].max_x_m), inverse_c);
      const auto y0 = hn::Mul(hn::Set(d, boxes[b].min_y_m), inverse_s);
      const auto y1 = hn::Mul(hn::Set(d, boxes[b].max_y_m), inverse_s);
      const auto entry = hn::Max(hn::Max(hn::Min(x0, x1), hn::Min(y0, y1)), zero);
      const auto exit = hn::Min(hn::Min(hn::Max(x0, x1), hn::Max(y0, y1)), last);
      const auto crosses = hn::Lt(entry, exit);
      from = hn::IfThenElse(crosses, hn::Min(from, entry), from);
      to = hn::IfThenElse(crosses, hn::Max(to, exit), to);
      const bool is_named = b < RayCrossings::kNamed;
      crossed = hn::Add(crossed, hn::IfThenElseZero(crosses, hn::Set(d, is_named ? power : 0.0)));
    }
    auto crosses = hn::Lt(from, to);
    const auto ray = hn::Iota(d, static_cast<double>(k));
    crosses = hn::And(crosses, hn::Lt(ray, hn::Set(d, static_cast<double>(fan.count))));
    if (hn::AllFalse(d, crosses)) return;
    hn::CompressStore(ray, crosses, d, found.ray + count);
    hn::CompressStore(c, crosses, d, found.cosine + count);
    hn::CompressStore(s, crosses, d, found.sine + count);
    hn::CompressStore(from, crosses, d, found.from_m + count);
    hn::CompressStore(to, crosses, d, found.to_m + count);
    hn::CompressStore(crossed, crosses, d, found.boxes + count);
    count += hn::CountTrue(d, crosses);
  };
  std::size_t k = 0;
  for (; k + lanes <= fan.count; k += lanes) cross(k, fan.cosine + k, fan.sine + k, end_m + k);
  if (k == fan.count) return count;
  double rest[3][RayCrossings::kSlack] = {};
  std::copy(fan.cosine + k, fan.cosine + fan.count, rest[0]);
  std::copy(fan.sine + k, fan.sine + fan.count, rest[1]);
  std::copy(end_m + k, end_m + fan.count, rest[2]);
  cross(k, rest[0], rest[1], rest[2]);
  return count;
}

}  // namespace strata::localization::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace strata::localization {

HWY_EXPORT(cross_boxes_lanes);

std::size_t cross_boxes(const RayFan& fan, const double* end_m, const RayBox* boxes,
                        std::size_t box_count, const RayCrossings& found) {
  return HWY_DYNAMIC_DISPATCH(cross_boxes_lanes)(fan, end_m, boxes, box_count, found);
}

}  // namespace strata::localization
#endif  // HWY_ONCE
