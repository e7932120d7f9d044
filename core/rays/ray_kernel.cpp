// SPDX-License-Identifier: Apache-2.0
// Highway compiles this file once for each SIMD target and picks one at run time.
#include "core/rays/ray_kernel.hpp"

#include <algorithm>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/rays/ray_kernel.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace strata::rays::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#include "core/rays/ray_lanes.inc"

/// Vectors that walk at the same time, so that one works while another waits for the table.
constexpr std::size_t kAbreast = 3;

/// Directions in the map of rays of a bundle.
HWY_INLINE void directions(const BeamBundle& bundle, const double* cosine, const double* sine,
                           Lanes& c, Lanes& s) {
  const Tag d;
  const auto hc = hn::Set(d, bundle.heading_cosine);
  const auto hs = hn::Set(d, bundle.heading_sine);
  const auto bc = hn::LoadU(d, cosine);
  const auto bs = hn::LoadU(d, sine);
  c = hn::Sub(hn::Mul(hc, bc), hn::Mul(hs, bs));
  s = hn::Add(hn::Mul(hs, bc), hn::Mul(hc, bs));
}

HWY_INLINE Rays rays_at(const RayTable& table, const BeamBundle& bundle, const double* cosine,
                        const double* sine) {
  const Tag d;
  Lanes c, s;
  directions(bundle, cosine, sine, c, s);
  const auto x = hn::Set(d, table.column_at(bundle.x_m));
  const auto y = hn::Set(d, table.row_at(bundle.y_m));
  return Rays(Axis(x, c, table.width), Axis(y, s, table.height), hn::Zero(d),
              hn::Set(d, bundle.max_range_m / table.resolution_m), false);
}

/// kAbreast vectors of rays.
HWY_INLINE void cast_block(const RayTable& table, const BeamBundle& bundle, const double* cosine,
                           const double* sine, double* range_m, std::int32_t* cell) {
  const Tag d;
  const std::size_t lanes = hn::Lanes(d);
  static_assert(kAbreast == 3);
  Rays a = rays_at(table, bundle, cosine, sine);
  Rays b = rays_at(table, bundle, cosine + lanes, sine + lanes);
  Rays c = rays_at(table, bundle, cosine + 2 * lanes, sine + 2 * lanes);
  while (!hn::AllFalse(d, hn::Or(hn::Or(a.is_active, b.is_active), c.is_active))) {
    a.step(table);
    b.step(table);
    c.step(table);
  }
  a.store(table.resolution_m, range_m, cell);
  b.store(table.resolution_m, range_m + lanes, cell + lanes);
  c.store(table.resolution_m, range_m + 2 * lanes, cell + 2 * lanes);
}

void cast_rays_lanes(const RayTable& table, const BeamBundle& bundle, double* range_m,
                     std::int32_t* cell) {
  const std::size_t block = kAbreast * hn::Lanes(Tag());
  std::size_t k = 0;
  for (; k + block <= bundle.count; k += block) {
    cast_block(table, bundle, bundle.cosine + k, bundle.sine + k, range_m + k, cell + k);
  }
  if (k == bundle.count) return;
  constexpr std::size_t kMax = kAbreast * kMaxLanes;
  double cosine[kMax];
  double sine[kMax];
  std::fill(cosine, cosine + kMax, bundle.cosine[k]);
  std::fill(sine, sine + kMax, bundle.sine[k]);
  std::copy(bundle.cosine + k, bundle.cosine + bundle.count, cosine);
  std::copy(bundle.sine + k, bundle.sine + bundle.count, sine);
  double ranges[kMax];
  std::int32_t cells[kMax];
  cast_block(table, bundle, cosine, sine, ranges, cells);
  std::copy(ranges, ranges + (bundle.count - k), range_m + k);
  std::copy(cells, cells + (bundle.count - k), cell + k);
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

void cast_batch_lanes(const RayTable& table, const RayBatch& batch, double* range_m,
                      std::int32_t* mark) {
  const Tag d;
  static_assert(kMaxLanes <= RayBatch::kSlack);
  const auto limit = hn::Set(d, batch.max_range_m / table.resolution_m);
  // Three walk abreast, as in cast_bundles.
  std::size_t next = 0;
  int walking = 0;
  struct Walker {
    Rays rays;
    Lanes skip;
    std::size_t at;
    bool is_walking;
  };
  const auto begin = [&](Walker& walker) HWY_ATTR {
    if (next >= batch.count) return;
    walker = {rays_of(table, batch, next), hn::Neg(hn::LoadU(d, batch.skip + next)), next, true};
    next += hn::Lanes(d);
    ++walking;
  };
  if (batch.count == 0) return;
  const Walker idle{rays_of(table, batch, 0), hn::Zero(d), 0, false};
  Walker a = idle;
  Walker b = idle;
  Walker c = idle;
  begin(a);
  begin(b);
  begin(c);
  const auto walk = [&](Walker& walker) HWY_ATTR {
    walker.rays.step(table, walker.skip);
    if (!walker.is_walking || !hn::AllFalse(d, walker.rays.is_active)) return;
    hn::StoreU(walker.rays.ranges(table.resolution_m, limit), d, range_m + walker.at);
    hn::StoreU(hn::DemoteTo(Places(), hn::Neg(walker.rays.met)), Places(), mark + walker.at);
    walker.is_walking = false;
    --walking;
    begin(walker);
  };
  while (walking > 0) {
    walk(a);
    walk(b);
    walk(c);
  }
}

}  // namespace strata::rays::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace strata::rays {

HWY_EXPORT(cast_rays_lanes);
HWY_EXPORT(cast_batch_lanes);

void cast_rays(const RayTable& table, const BeamBundle& bundle, double* range_m,
               std::int32_t* cell) {
  HWY_DYNAMIC_DISPATCH(cast_rays_lanes)(table, bundle, range_m, cell);
}

void cast_batch(const RayTable& table, const RayBatch& batch, double* range_m, std::int32_t* mark) {
  HWY_DYNAMIC_DISPATCH(cast_batch_lanes)(table, batch, range_m, mark);
}

}  // namespace strata::rays
#endif  // HWY_ONCE
