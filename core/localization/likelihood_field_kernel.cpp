// SPDX-License-Identifier: Apache-2.0
// Highway compiles this file once for each SIMD target and picks one at run time.
#include "core/localization/likelihood_field_kernel.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/localization/likelihood_field_kernel.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace strata::localization::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void sum_lanes(const FieldTable& table, const FieldPoses& poses, const FieldPoints& points,
               float* sums) {
  const hn::ScalableTag<float> d;
  const hn::RebindToSigned<decltype(d)> di;
  const std::size_t lanes = hn::Lanes(d);
  const auto zero = hn::Zero(d);
  const auto last_x = hn::Set(d, static_cast<float>(table.width - 1));
  const auto last_y = hn::Set(d, static_cast<float>(table.height - 1));
  const auto width = hn::Set(di, table.width);
  std::size_t i = 0;
  for (; i + lanes <= poses.count; i += lanes) {
    const auto x = hn::LoadU(d, poses.x + i);
    const auto y = hn::LoadU(d, poses.y + i);
    const auto c = hn::LoadU(d, poses.cosine + i);
    const auto s = hn::LoadU(d, poses.sine + i);
    auto sum = hn::Zero(d);
    for (std::size_t k = 0; k < points.count; ++k) {
      const auto px = hn::Set(d, points.x[k]);
      const auto py = hn::Set(d, points.y[k]);
      auto u = hn::Add(x, hn::Sub(hn::Mul(c, px), hn::Mul(s, py)));
      auto v = hn::Add(y, hn::Add(hn::Mul(s, px), hn::Mul(c, py)));
      u = hn::Min(hn::Max(u, zero), last_x);
      v = hn::Min(hn::Max(v, zero), last_y);
      const auto index = hn::Add(hn::Mul(hn::ConvertTo(di, v), width), hn::ConvertTo(di, u));
      sum = hn::Add(sum, hn::GatherIndex(d, table.values, index));
    }
    hn::StoreU(sum, d, sums + i);
  }
  const FieldPoses rest{poses.x + i, poses.y + i, poses.cosine + i, poses.sine + i,
                        poses.count - i};
  sum_field_scalar(table, rest, points, sums + i);
}

}  // namespace strata::localization::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace strata::localization {

HWY_EXPORT(sum_lanes);

void sum_field(const FieldTable& table, const FieldPoses& poses, const FieldPoints& points,
               float* sums) {
  HWY_DYNAMIC_DISPATCH(sum_lanes)(table, poses, points, sums);
}

void sum_field_scalar(const FieldTable& table, const FieldPoses& poses, const FieldPoints& points,
                      float* sums) {
  const auto last_x = static_cast<float>(table.width - 1);
  const auto last_y = static_cast<float>(table.height - 1);
  for (std::size_t i = 0; i < poses.count; ++i) {
    float sum = 0.0F;
    for (std::size_t k = 0; k < points.count; ++k) {
      float u = poses.x[i] + (poses.cosine[i] * points.x[k] - poses.sine[i] * points.y[k]);
      float v = poses.y[i] + (poses.sine[i] * points.x[k] + poses.cosine[i] * points.y[k]);
      u = u < 0.0F ? 0.0F : (u > last_x ? last_x : u);
      v = v < 0.0F ? 0.0F : (v > last_y ? last_y : v);
      const std::int32_t index =
          static_cast<std::int32_t>(v) * table.width + static_cast<std::int32_t>(u);
      sum += table.values[index];
    }
    sums[i] = sum;
  }
}

}  // namespace strata::localization
#endif  // HWY_ONCE
