// SPDX-License-Identifier: Apache-2.0
#include "memory/decoding/relax_kernel.hpp"

#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "memory/decoding/relax_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace strata::memory::detail::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Four target states at a time: each loaded vector is used four times, and four chains of minima
/// run side by side.
void relax_lanes(const double* HWY_RESTRICT from, const double* HWY_RESTRICT edges,
                 std::size_t states, std::size_t width, std::size_t stride,
                 double* HWY_RESTRICT to) {
  const hn::CappedTag<double, kStartLanes> tag;
  const auto none = hn::Set(tag, std::numeric_limits<double>::infinity());
  for (std::size_t s = 0; s < stride; s += hn::Lanes(tag)) {
    std::size_t j = 0;
    for (; j + 4 <= width; j += 4) {
      auto a = none;
      auto b = none;
      auto c = none;
      auto d = none;
      for (std::size_t i = 0; i < states; ++i) {
        const auto cost = hn::LoadU(tag, from + i * stride + s);
        const double* edge = edges + i * width + j;
        a = hn::Min(a, hn::Add(cost, hn::Set(tag, edge[0])));
        b = hn::Min(b, hn::Add(cost, hn::Set(tag, edge[1])));
        c = hn::Min(c, hn::Add(cost, hn::Set(tag, edge[2])));
        d = hn::Min(d, hn::Add(cost, hn::Set(tag, edge[3])));
      }
      hn::StoreU(a, tag, to + j * stride + s);
      hn::StoreU(b, tag, to + (j + 1) * stride + s);
      hn::StoreU(c, tag, to + (j + 2) * stride + s);
      hn::StoreU(d, tag, to + (j + 3) * stride + s);
    }
    for (; j < width; ++j) {
      auto a = none;
      for (std::size_t i = 0; i < states; ++i) {
        const auto cost = hn::LoadU(tag, from + i * stride + s);
        a = hn::Min(a, hn::Add(cost, hn::Set(tag, edges[i * width + j])));
      }
      hn::StoreU(a, tag, to + j * stride + s);
    }
  }
}

}  // namespace strata::memory::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace strata::memory::detail {

HWY_EXPORT(relax_lanes);

void relax(const double* from, const double* edges, std::size_t states, std::size_t width,
           std::size_t stride, double* to) {
  HWY_DYNAMIC_DISPATCH(relax_lanes)(from, edges, states, width, stride, to);
}

}  // namespace strata::memory::detail
#endif
