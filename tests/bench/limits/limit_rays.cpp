// SPDX-License-Identifier: Apache-2.0
// Highway compiles this file once for each SIMD target and picks one at run time.
#include <cmath>

#include "tests/bench/limits/limits.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/bench/limits/limit_rays.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace strata::limit::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
#include "tests/bench/limits/lanes.inc"

std::size_t traverse_lanes(const std::vector<Segment>& segments, std::int32_t width,
                           CellSum* cells) {
  std::size_t visited = 0;
  for (const Segment& segment : segments) {
    const float dx = segment.x1 - segment.x0;
    const float dy = segment.y1 - segment.y0;
    const float length = std::sqrt(dx * dx + dy * dy);
    const auto i0 = static_cast<std::int32_t>(segment.x0);
    const auto j0 = static_cast<std::int32_t>(segment.y0);
    const std::int32_t columns = std::abs(static_cast<std::int32_t>(segment.x1) - i0);
    const std::int32_t rows = std::abs(static_cast<std::int32_t>(segment.y1) - j0);
    const float delta_x = columns > 0 ? length / std::abs(dx) : 1e30F;
    const float delta_y = rows > 0 ? length / std::abs(dy) : 1e30F;
    const auto edge = [](float start, std::int32_t cell, float d) HWY_ATTR {
      return d > 0.0F ? static_cast<float>(cell + 1) - start : start - static_cast<float>(cell);
    };
    float next_x = columns > 0 ? edge(segment.x0, i0, dx) * delta_x : 1e30F;
    float next_y = rows > 0 ? edge(segment.y0, j0, dy) * delta_y : 1e30F;
    const std::int32_t step_x = dx > 0.0F ? 1 : -1;
    const std::int32_t step_y = dy > 0.0F ? width : -width;
    CellSum* cell = cells + static_cast<std::ptrdiff_t>(j0) * width + i0;
    float t = 0.0F;
    for (std::int32_t left = columns + rows; left > 0; --left) {
      const bool is_x = next_x < next_y;
      const float next = is_x ? next_x : next_y;
      cell->length += next - t;
      ++cell->count;
      t = next;
      cell += is_x ? step_x : step_y;
      next_x += is_x ? delta_x : 0.0F;
      next_y += is_x ? 0.0F : delta_y;
    }
    cell->length += length - t;
    ++cell->count;
    visited += static_cast<std::size_t>(columns + rows + 1);
  }
  return visited;
}

void cast_lanes(const Field& distances, const float* x, const float* y, const float* c,
                const float* s, std::size_t count, float most, float* ranges) {
  const D d;
  const DI di;
  const std::size_t lanes = hn::Lanes(d);
  const auto zero = hn::Zero(d);
  const auto last_x = hn::Set(d, static_cast<float>(distances.width - 1));
  const auto last_y = hn::Set(d, static_cast<float>(distances.height - 1));
  const auto width = hn::Set(di, distances.width);
  const auto limit = hn::Set(d, most);
  const auto near = hn::Set(d, 0.75F);
  for (std::size_t i = 0; i + lanes <= count; i += lanes) {
    const auto x0 = hn::LoadU(d, x + i);
    const auto y0 = hn::LoadU(d, y + i);
    const auto dx = hn::LoadU(d, c + i);
    const auto dy = hn::LoadU(d, s + i);
    auto t = zero;
    while (true) {
      const auto u = hn::Min(hn::Max(hn::MulAdd(t, dx, x0), zero), last_x);
      const auto v = hn::Min(hn::Max(hn::MulAdd(t, dy, y0), zero), last_y);
      const auto index = hn::Add(hn::Mul(hn::ConvertTo(di, v), width), hn::ConvertTo(di, u));
      const auto free = hn::GatherIndex(d, distances.values, index);
      const auto goes_on = hn::And(hn::Gt(free, near), hn::Lt(t, limit));
      if (hn::AllFalse(d, goes_on)) break;
      t = hn::Add(t, hn::IfThenElseZero(goes_on, free));
    }
    hn::StoreU(hn::Min(t, limit), d, ranges + i);
  }
}

}  // namespace strata::limit::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace strata::limit {

HWY_EXPORT(traverse_lanes);
HWY_EXPORT(cast_lanes);

std::size_t traverse(const std::vector<Segment>& segments, std::int32_t width, CellSum* cells) {
  return HWY_DYNAMIC_DISPATCH(traverse_lanes)(segments, width, cells);
}

void cast(const Field& distances, const float* x, const float* y, const float* c, const float* s,
          std::size_t count, float most, float* ranges) {
  HWY_DYNAMIC_DISPATCH(cast_lanes)(distances, x, y, c, s, count, most, ranges);
}

}  // namespace strata::limit
#endif  // HWY_ONCE
