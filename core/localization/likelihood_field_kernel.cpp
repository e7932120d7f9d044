// SPDX-License-Identifier: Apache-2.0
// Highway compiles this file once for each SIMD target and picks one at run time.
#include "core/localization/likelihood_field_kernel.hpp"

#include <algorithm>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/localization/likelihood_field_kernel.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace strata::localization::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Points whose cells are found before any is looked up.
constexpr std::size_t kBlock = 512;

/// Cells of `count` points, lanes <= count <= kBlock, seen from one pose.
HWY_INLINE void find_cells(const FieldTable& table, const FieldPoses& poses, std::size_t pose,
                           const float* px, const float* py, std::size_t count,
                           std::int32_t* cells) {
  const hn::ScalableTag<float> d;
  const hn::RebindToSigned<decltype(d)> di;
  const std::size_t lanes = hn::Lanes(d);
  const auto zero = hn::Zero(d);
  const auto last_x = hn::Set(d, static_cast<float>(table.width - 1));
  const auto last_y = hn::Set(d, static_cast<float>(table.height - 1));
  const auto width = hn::Set(di, table.width);
  const auto x = hn::Set(d, poses.x[pose]);
  const auto y = hn::Set(d, poses.y[pose]);
  const auto c = hn::Set(d, poses.cosine[pose]);
  const auto s = hn::Set(d, poses.sine[pose]);
  for (std::size_t k = 0; k < count; k += lanes) {
    k = std::min(k, count - lanes);  // the last vector may find some cells twice
    const auto u0 = hn::LoadU(d, px + k);
    const auto v0 = hn::LoadU(d, py + k);
    auto u = hn::Add(x, hn::Sub(hn::Mul(c, u0), hn::Mul(s, v0)));
    auto v = hn::Add(y, hn::Add(hn::Mul(s, u0), hn::Mul(c, v0)));
    u = hn::Min(hn::Max(u, zero), last_x);
    v = hn::Min(hn::Max(v, zero), last_y);
    const auto index = hn::Add(hn::Mul(hn::ConvertTo(di, v), width), hn::ConvertTo(di, u));
    hn::StoreU(index, di, cells + k);
  }
}

/// Sum of the values at `cells`. Two cells are read at a time and four sums run side by side.
HWY_INLINE std::uint32_t look_up(const std::uint16_t* HWY_RESTRICT values,
                                 const std::int32_t* HWY_RESTRICT cells, std::size_t count) {
  const auto pair_at = [&](std::size_t k) {
    std::uint64_t pair = 0;
    std::memcpy(&pair, cells + k, sizeof(pair));
    return pair;
  };
  std::uint32_t a = 0;
  std::uint32_t b = 0;
  std::uint32_t c = 0;
  std::uint32_t d = 0;
  std::size_t k = 0;
  for (; k + 4 <= count; k += 4) {
    const std::uint64_t first = pair_at(k);
    const std::uint64_t second = pair_at(k + 2);
    a += values[first & 0xFFFFFFFFU];
    b += values[first >> 32U];
    c += values[second & 0xFFFFFFFFU];
    d += values[second >> 32U];
  }
  for (; k < count; ++k) a += values[cells[k]];
  return (a + b) + (c + d);
}

void sum_lanes(const FieldTable& table, const FieldPoses& poses, const FieldPoints& points,
               std::uint32_t* sums) {
  const std::size_t lanes = hn::Lanes(hn::ScalableTag<float>());
  const std::size_t whole = points.count < lanes ? 0 : points.count;
  alignas(64) std::int32_t cells[kBlock];
  sum_field_scalar(table, poses, {points.x, points.y, points.count - whole}, sums);
  for (std::size_t i = 0; i < poses.count; ++i) {
    std::size_t begin = 0;
    while (begin < whole) {
      // No block may be shorter than a vector.
      const std::size_t left = whole - begin;
      const std::size_t count = left <= kBlock ? left : std::min(kBlock, left - lanes);
      find_cells(table, poses, i, points.x + begin, points.y + begin, count, cells);
      sums[i] += look_up(table.values, cells, count);
      begin += count;
    }
  }
}

}  // namespace strata::localization::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace strata::localization {

HWY_EXPORT(sum_lanes);

void sum_field(const FieldTable& table, const FieldPoses& poses, const FieldPoints& points,
               std::uint32_t* sums) {
  HWY_DYNAMIC_DISPATCH(sum_lanes)(table, poses, points, sums);
}

void sum_field_scalar(const FieldTable& table, const FieldPoses& poses, const FieldPoints& points,
                      std::uint32_t* sums) {
  const auto last_x = static_cast<float>(table.width - 1);
  const auto last_y = static_cast<float>(table.height - 1);
  for (std::size_t i = 0; i < poses.count; ++i) {
    std::uint32_t sum = 0;
    for (std::size_t k = 0; k < points.count; ++k) {
      float u = poses.x[i] + (poses.cosine[i] * points.x[k] - poses.sine[i] * points.y[k]);
      float v = poses.y[i] + (poses.sine[i] * points.x[k] + poses.cosine[i] * points.y[k]);
      u = std::min(std::max(u, 0.0F), last_x);
      v = std::min(std::max(v, 0.0F), last_y);
      const std::int32_t index =
          static_cast<std::int32_t>(v) * table.width + static_cast<std::int32_t>(u);
      sum += table.values[index];
    }
    sums[i] = sum;
  }
}

}  // namespace strata::localization
#endif  // HWY_ONCE
